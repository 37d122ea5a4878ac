/* tests/catalyst/impl.c - the exported record, as Catalyst's CMake function
 * makes it. */
#include <catalyst_impl_snowglass.h>

extern const struct catalyst_impl catalyst_api_impl;

__attribute__((visibility("default")))
const struct catalyst_impl catalyst_api_impl = {
    1,
    catalyst_initialize_snowglass,
    catalyst_execute_snowglass,
    catalyst_finalize_snowglass,
    catalyst_about_snowglass,
    catalyst_results_snowglass,
};
