/* comm/self.c - a group of one: a mailbox with a single rank, so that code for
 * many ranks needs no special case for one. */
#include "comm/mailbox.h"

snow_status snow_comm_new_self(snow_context *context, snow_comm **out) {
    snow_mailbox *mailbox;
    SNOW_TRY(snow_mailbox_new(context, 1, &mailbox));
    snow_status status = snow_mailbox_comm(mailbox, context, 0, true, out);
    if (status != SNOW_STATUS_OK)
        snow_mailbox_free(mailbox);
    return status;
}
