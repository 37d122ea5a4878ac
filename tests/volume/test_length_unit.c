/* tests/volume/test_length_unit.c - units of length have one table, whatever
 * their spelling.  Sources: the brochure of the SI, UDUNITS-2, and the schemas
 * of OME and ImageJ for the signs. */
#include "support/support.h"

#include <stdio.h>
#include <string.h>

static void spellings_are_one_unit(void **state) {
    (void)state;
    static const struct {
        const char *name;
        double picometres;
        const char *spellings; /* between bars */
    } units[] = {
        {"pm", 1, "pm|picometer|Picometres"},
        {"angstrom", 100,
         "A|angstrom|Angstroms|\xc3\x85|\xe2\x84\xab|\xc3\x85ngstr\xc3\xb6m"},
        {"nm", 1e3, "nm|NM|nanometer|nanometres"},
        {"um", 1e6,
         "um|\xc2\xb5m|\xce\xbcm|\xb5m|\\u00B5m|&#181;m|micron|Microns|"
         "micrometer|micrometre|MICROMETERS| um |\"um\""},
        {"mm", 1e9, "mm|MM|millimeter|millimetres"},
        {"cm", 1e10, "cm|centimetre"},
        {"in", 2.54e10, "in|inch|inches"},
        {"m", 1e12, "m|meter|metres"},
        {"km", 1e15, "km|kilometers|kilometre"},
        {"", 0,
         "|s|mi|pixel|degrees|microfortnight|micro|ms|milli|re|meters per "
         "second|a very long text that is no unit of length"},
    };
    for (size_t i = 0; i < sizeof units / sizeof *units; i++) {
        char text[64];
        const char *next = units[i].spellings;
        for (const char *at = next; next; at = next + 1) {
            next = strchr(at, '|');
            snprintf(text, sizeof text, "%.*s", (int)strcspn(at, "|"), at);
            char name[16] = "";
            const double picometres = snow_unit_length(text, name);
            if (picometres != units[i].picometres ||
                strcmp(name, units[i].name) != 0)
                fail_msg("'%s' is %g pm, \"%s\"", text, picometres, name);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(spellings_are_one_unit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
