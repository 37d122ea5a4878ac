/* tests/catalyst/catalyst_impl_snowglass.h - what Catalyst's CMake function
 * makes for an implementation of that name. */
#ifndef STUB_CATALYST_IMPL_SNOWGLASS_H
#define STUB_CATALYST_IMPL_SNOWGLASS_H

#include <catalyst.h>

enum catalyst_status catalyst_initialize_snowglass(const conduit_node *);
enum catalyst_status catalyst_execute_snowglass(const conduit_node *);
enum catalyst_status catalyst_finalize_snowglass(const conduit_node *);
enum catalyst_status catalyst_about_snowglass(conduit_node *);
enum catalyst_status catalyst_results_snowglass(conduit_node *);

#endif
