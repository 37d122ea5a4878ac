/* comm/self.c - a group of one: a post office with a single box, so that what
 * is written for many ranks needs no other way for one. */
#include "comm/office.h"

snow_status snow_comm_self(snow_context *context, snow_comm **out) {
    snow_office *office;
    SNOW_TRY(snow_office_new(context, 1, &office));
    snow_status status = snow_office_comm(office, context, 0, true, out);
    if (status != SNOW_OK)
        snow_office_free(office);
    return status;
}
