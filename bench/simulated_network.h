/* bench/simulated_network.h - ranks of this process on a cluster that is not
 * there. */
#ifndef BENCH_SIMULATED_NETWORK_H
#define BENCH_SIMULATED_NETWORK_H

#include <snowglass/comm.h>

/* A cluster to be simulated: one processor a node, a port each way, and a
 * network between the ports that never is the bottleneck (a crossbar). */
typedef struct snow_network {
    double latency;   /* seconds from port to port */
    double bandwidth; /* bytes per second of a port, above 0 */
    double overhead;  /* seconds of the processor per message, at both ends */
    double slowness;  /* seconds of the simulated processor per second of this
                         one's, above 0 */
} snow_network;

/* As snow_comm_run_threads, in simulated time: a rank's clock
 * (snow_comm_seconds) runs with the processor time of its own thread, and
 * messages take the network's. Ranks compute one at a time, so that they do not
 * disturb one another: times are meant to be read, not waited for.  A body that
 * shares its work with other threads is simulated wrongly. */
snow_status snow_comm_run_simulated(snow_context *context, int ranks,
                                    const snow_network *network,
                                    snow_comm_body_fn *body, void *user);

#endif
