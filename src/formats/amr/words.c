/* formats/amr/words.c - lines of text as AMReX writes them. */
#include "formats/amr/amr.h"

snow_status snow_amr_refuse(snow_context *context, const char *line,
                            const char *what) {
    return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                     "its line \"%.80s\" should be %s; it is damaged, copy it "
                     "again",
                     line, what);
}

snow_status snow_amr_line(snow_source *source, char *line, size_t bytes,
                          const char *what) {
    bool got;
    SNOW_TRY(snow_source_read_line(source, line, bytes, &got));
    return got ? SNOW_STATUS_OK
               : snow_fail(snow_source_context(source), SNOW_STATUS_BAD_INPUT,
                           "ends before %s; it is cut off, copy it again",
                           what);
}
