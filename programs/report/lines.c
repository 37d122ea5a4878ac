/* lines.c - headers of text: NRRD ("sizes: 4 5 6", "key:=value") and MetaImage
 * ("DimSize = 4 5 6").  A line whose key is not technical is a length. */
#include "report/report.h"

#include <string.h>

#define LINES 500

/* Of a key with several words, such as "space directions", each must be
 * known. */
static bool is_key(const char *text, size_t length) {
    size_t at = 0;
    while (at < length) {
        size_t word = 0;
        while (at + word < length && text[at + word] != ' ')
            word++;
        if (word && !is_technical(text + at, word))
            return false;
        at += word + 1;
    }
    return length > 0;
}

/* `parts` separates key and value. */
static void put_line(FILE *out, const char *line, size_t length, char parts) {
    const char *sign = memchr(line, parts, length);
    size_t key = sign ? (size_t)(sign - line) : 0;
    while (key && line[key - 1] == ' ')
        key--;
    if (!sign) {
        fprintf(out, "line of %zu bytes\n", length);
        return;
    }
    const bool own = parts == ':' && sign + 1 < line + length && sign[1] == '=';
    const char *value = sign + (own ? 2 : 1), *end = line + length;
    while (value < end && *value == ' ')
        value++;
    const size_t left = (size_t)(end - value);
    if (own || !is_key(line, key)) {
        fprintf(out, "key of %zu bytes, value of %zu bytes\n", key, left);
        return;
    }
    fprintf(out, "%.*s%s ", (int)key, line, parts == ':' ? ":" : " =");
    put_text(out, value, left);
    putc('\n', out);
}

static size_t line_length(const char *text, size_t left) {
    const char *end = memchr(text, '\n', left);
    return end ? (size_t)(end - text) : left;
}

bool report_text(FILE *out, const source *from) {
    const char *text = (const char *)from->head;
    const bool nrrd = from->head_size > 8 && memcmp(text, "NRRD000", 7) == 0;
    const bool meta =
        from->head_size > 16 &&
        (memcmp(text, "ObjectType", 10) == 0 || memcmp(text, "NDims", 5) == 0);
    size_t left = from->head_size;
    if (!nrrd && !meta)
        return false;
    if (nrrd)
        fprintf(out, "NRRD000%c\n",
                text[7] >= '1' && text[7] <= '9' ? text[7] : '?');
    for (int n = 0; n < LINES && left; n++) {
        size_t length = line_length(text, left), used = length;
        if (used && text[used - 1] == '\r')
            used--;
        if (nrrd && used == 0)
            break;
        if ((n > 0 || meta) && used && *text != '#')
            put_line(out, text, used, nrrd ? ':' : '=');
        if (meta && memcmp(text, "ElementDataFile", used < 15 ? used : 15) == 0)
            break;
        length += length < left;
        text += length;
        left -= length;
    }
    fprintf(out, "header of %td bytes\n", text - (const char *)from->head);
    return true;
}
