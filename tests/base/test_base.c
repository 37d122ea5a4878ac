/* tests/base/test_base.c - contexts, memory and numbers keep their promises. */
#include "support/support.h"

static void
a_failed_allocation_tells_its_size_and_changes_nothing(void **state) {
    (void)state;
    snow_context *context = support_context();
    assert_null(snow_allocate(context, SIZE_MAX / 2));
    assert_non_null(strstr(snow_context_message(context), "out of memory"));
    assert_int_equal(snow_context_bytes(context), 0);
    snow_context_free(context);
}

static void blocks_are_aligned_and_counted(void **state) {
    (void)state;
    snow_context *context = support_context();
    void *a = snow_allocate(context, 1), *b = snow_allocate(context, 100);
    assert_int_equal((uintptr_t)a % 64, 0);
    assert_int_equal((uintptr_t)b % 64, 0);
    assert_int_equal(snow_context_bytes(context), 101);
    snow_release(context, a);
    snow_release(context, b);
    assert_int_equal(snow_context_bytes(context), 0);
    assert_int_equal(snow_context_peak_bytes(context), 101);
    snow_context_free(context);
}

static void products_that_overflow_are_refused(void **state) {
    (void)state;
    uint64_t product = 7;
    assert_false(snow_mul_u64(UINT64_MAX / 2, 3, &product));
    assert_int_equal(product, 7);
    assert_true(snow_mul_u64(UINT32_MAX, UINT32_MAX, &product));
    assert_true(product == (uint64_t)UINT32_MAX * UINT32_MAX);
}

static void a_reserved_block_keeps_its_bytes(void **state) {
    (void)state;
    snow_context *context = support_context();
    char *block = NULL;
    assert_int_equal(SNOW_RESERVE(context, block, 0, 3), SNOW_STATUS_OK);
    memcpy(block, "abc", 3);
    assert_int_equal(SNOW_RESERVE(context, block, 3, 999), SNOW_STATUS_OK);
    assert_memory_equal(block, "abc", 3);
    assert_true(snow_block_bytes(block) >= 999);
    snow_release(context, block);
    snow_context_free(context);
}

/* --- blocks of 2 MB and more, which ask for huge pages ----------------------
 */

#define LARGE ((size_t)2 << 20)

static bool is_all(const unsigned char *block, size_t bytes, int value) {
    for (size_t n = 0; n < bytes; n++)
        if (block[n] != value)
            return false;
    return true;
}

/* Of every size near the bound: what one writes into a block stays there, and
 * stays out of its neighbours. */
static void large_blocks_are_aligned_and_apart(void **state) {
    (void)state;
    static const size_t sizes[] = {LARGE - 200, LARGE - 129,  LARGE - 128,
                                   LARGE - 127, LARGE - 1,    LARGE,
                                   LARGE + 1,   LARGE + 4095, 3 * LARGE + 7};
    enum { COUNT = sizeof sizes / sizeof *sizes };
    snow_context *context = support_context();
    unsigned char *blocks[COUNT];
    uint64_t sum = 0;
    for (int n = 0; n < COUNT; n++) {
        blocks[n] = snow_allocate(context, sizes[n]);
        assert_non_null(blocks[n]);
        assert_int_equal((uintptr_t)blocks[n] % SNOW_ALIGNMENT, 0);
        assert_int_equal(snow_block_bytes(blocks[n]), sizes[n]);
        memset(blocks[n], n + 1, sizes[n]);
        sum += sizes[n];
    }
    assert_int_equal(snow_context_bytes(context), sum);
    for (int n = 0; n < COUNT; n++) {
        assert_true(is_all(blocks[n], sizes[n], n + 1));
        snow_release(context, blocks[n]);
    }
    assert_int_equal(snow_context_bytes(context), 0);
    snow_context_free(context);
}

/* Also where the memory was another block's before. */
static void large_blocks_are_clear_where_that_is_asked(void **state) {
    (void)state;
    snow_context *context = support_context();
    for (int n = 0; n < 4; n++) {
        unsigned char *block = snow_allocate_clear(context, LARGE + 5);
        assert_non_null(block);
        assert_true(is_all(block, LARGE + 5, 0));
        memset(block, 0xff, LARGE + 5);
        snow_release(context, block);
    }
    snow_context_free(context);
}

/* From a small block to larger and larger ones. */
static void large_blocks_grow_with_what_they_hold(void **state) {
    (void)state;
    snow_context *context = support_context();
    unsigned char *block = NULL;
    size_t held = 0;
    for (size_t size = LARGE / 4; size < 8 * LARGE; size += size / 2 + 1) {
        assert_int_equal(SNOW_RESERVE(context, block, held, size),
                         SNOW_STATUS_OK);
        assert_int_equal((uintptr_t)block % SNOW_ALIGNMENT, 0);
        assert_true(is_all(block, held, 0x5a));
        assert_true(snow_block_bytes(block) >= size);
        assert_int_equal(snow_context_bytes(context), snow_block_bytes(block));
        memset(block, 0x5a, size);
        held = size;
    }
    snow_release(context, block);
    assert_int_equal(snow_context_bytes(context), 0);
    snow_context_free(context);
}

/* Pages of the process' memory; 0 where the system does not say. */
static long resident(void) {
    long all = 0, pages = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    if (file && fscanf(file, "%ld %ld", &all, &pages) != 2)
        pages = 0;
    if (file)
        fclose(file);
    return pages;
}

/* 64 blocks of 16 MB one after another; sanitizers keep what was freed for a
 * while, and look for leaks themselves. */
static void large_blocks_go_back_to_the_system(void **state) {
    (void)state;
#ifdef __SANITIZE_ADDRESS__
    skip();
#endif
    snow_context *context = support_context();
    const size_t bytes = 8 * LARGE;
    const long before = resident();
    for (int n = 0; n < 64; n++) {
        unsigned char *block = snow_allocate(context, bytes);
        assert_non_null(block);
        memset(block, 1, bytes);
        snow_release(context, block);
    }
    assert_true(resident() - before < (long)(4 * bytes / 4096));
    snow_context_free(context);
}

static void numbers_are_whole_or_refused(void **state) {
    (void)state;
    int64_t i = 5;
    double d = 5;
    assert_false(snow_parse_int64("12x", &i));
    assert_false(snow_parse_int64("", &i));
    assert_false(snow_parse_int64("99999999999999999999", &i));
    assert_int_equal(i, 5);
    assert_true(snow_parse_int64(" -12 ", &i));
    assert_int_equal(i, -12);
    assert_false(snow_parse_double("1.5,", &d));
    assert_true(snow_parse_double("1.5e3", &d));
    assert_true(d == 1500);
    assert_false(snow_parse_double("0x10", &d));
    assert_true(d == 1500);
}

/* Bytes as ls --escape writes them; letters of UTF-8 stay, but for those that
 * turn the direction of text (U+202E) and controls of Latin-1 (U+009B). */
static void a_message_is_one_line_whatever_it_quotes(void **state) {
    static const char *const cases[][2] = {
        {"a\nb\x1b[2J\x7f", "a\\nb\\033[2J\\177"},
        {"gr\xc3\xb6\xc3\x9f"
         "er \xe2\x82\xac \xf0\x9f\x98\x80",
         "gr\xc3\xb6\xc3\x9f"
         "er \xe2\x82\xac \xf0\x9f\x98\x80"},
        {"\xff\xc3", "\\377\\303"},
        {"\xe2\x80\xae"
         "gnp",
         "\\342\\200\\256gnp"},
        {"\xc2\x9b"
         "2J",
         "\\302\\2332J"},
        {"\xc0\xaf\xed\xa0\x80", "\\300\\257\\355\\240\\200"},
    };
    (void)state;
    snow_context *context = support_context();
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        snow_fail(context, SNOW_STATUS_BAD_INPUT, "%s", cases[i][0]);
        assert_string_equal(snow_context_message(context), cases[i][1]);
    }
    snow_context_free(context);
}

/* Of a long name the end is left, of another word the beginning. */
static void long_words_are_shortened(void **state) {
    char word[100001];
    (void)state;
    snow_context *context = support_context();
    for (size_t length = 90; length < sizeof word; length += length / 5) {
        const size_t kept = length > 100 ? 100 : length;
        const size_t name = length > 200 ? 200 : length;
        memset(word, 'w', length);
        word[length] = 0;
        snow_fail(context, SNOW_STATUS_BAD_INPUT, "no %s here", word);
        const char *told = snow_context_message(context);
        assert_int_equal(strlen(told), 8 + kept - (length > 10230 ? 5 : 0));
        word[0] = '/';
        memcpy(word + length - 4, ".nii", 4);
        snow_fail(context, SNOW_STATUS_BAD_INPUT, "%.9000s: empty", word);
        assert_int_equal(strcspn(told, ":"), name);
    }
    snow_context_free(context);
}

static void layers_add_what_they_know_to_a_message(void **state) {
    (void)state;
    snow_context *context = support_context();
    snow_fail(context, SNOW_STATUS_BAD_INPUT, "line %d is empty", 3);
    assert_int_equal(snow_fail_within(context, SNOW_STATUS_BAD_INPUT, "a.nrrd"),
                     SNOW_STATUS_BAD_INPUT);
    assert_string_equal(snow_context_message(context),
                        "a.nrrd: line 3 is empty");
    snow_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(
            a_failed_allocation_tells_its_size_and_changes_nothing),
        cmocka_unit_test(blocks_are_aligned_and_counted),
        cmocka_unit_test(products_that_overflow_are_refused),
        cmocka_unit_test(a_reserved_block_keeps_its_bytes),
        cmocka_unit_test(large_blocks_are_aligned_and_apart),
        cmocka_unit_test(large_blocks_are_clear_where_that_is_asked),
        cmocka_unit_test(large_blocks_grow_with_what_they_hold),
        cmocka_unit_test(large_blocks_go_back_to_the_system),
        cmocka_unit_test(numbers_are_whole_or_refused),
        cmocka_unit_test(a_message_is_one_line_whatever_it_quotes),
        cmocka_unit_test(long_words_are_shortened),
        cmocka_unit_test(layers_add_what_they_know_to_a_message),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
