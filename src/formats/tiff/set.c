/* formats/tiff/set.c - the files of an OME image: each names all others, or the
 * one that does.
 *
 * A file is found by its name beside the one that is opened, else by its UUID,
 * as it may have been renamed.  One other file is open at a time. */
#include "formats/array.h"
#include "formats/tiff/tiff.h"
#include "io/folder.h"

#include <stdio.h>
#include <string.h>

#if SNOW_HAVE_TIFF && !SNOW_LOADS

/* --- one file ------------------------------------------------------------- */

snow_status snow_tiff_compare(snow_tiff *file, const tiff_page *page,
                              int64_t number) {
    tiff_page own;
    SNOW_TRY(snow_tiff_describe(file, &own));
    if (own.width == page->width && own.height == page->height &&
        own.samples == page->samples && own.type == page->type &&
        own.bits == page->bits && own.coding == page->coding)
        return SNOW_STATUS_OK;
    return snow_fail(file->context, SNOW_STATUS_BAD_INPUT,
                     "page %lld has %lldx%lld pixels of %lld x %s (%d bits), "
                     "but the first has %lldx%lld of %lld x %s (%d bits); all "
                     "slices of a volume must be alike",
                     (long long)number, (long long)own.width,
                     (long long)own.height, (long long)own.samples,
                     snow_type_name(own.type), own.bits, (long long)page->width,
                     (long long)page->height, (long long)page->samples,
                     snow_type_name(page->type), page->bits);
}

snow_status snow_tiff_list_pages(tiff_reader *reader, bool all,
                                 const tiff_page *page, int64_t most) {
    snow_tiff *file = &reader->file;
    for (bool got = true; got;) {
        uint32_t kind = 0;
        TIFFGetFieldDefaulted(file->tiff, TIFFTAG_SUBFILETYPE, &kind);
        /* Thumbnails of others and masks are no slices. */
        if (all || !reader->count ||
            !(kind & (FILETYPE_REDUCEDIMAGE | FILETYPE_MASK))) {
            if (page && reader->count && reader->count < most)
                SNOW_TRY(snow_tiff_compare(file, page, reader->count));
            SNOW_TRY(SNOW_RESERVE(file->context, reader->pages, reader->count,
                                  reader->count + 1));
            reader->pages[reader->count++] = TIFFCurrentDirOffset(file->tiff);
        }
        SNOW_TRY(snow_tiff_next(file, &got));
    }
    return SNOW_STATUS_OK;
}

static void close_reader(tiff_reader *reader) {
    if (reader->open) {
        snow_tiff_close(&reader->file);
        snow_release(reader->file.context, reader->pages);
    }
    if (reader->source)
        snow_source_close(reader->source);
    *reader = (tiff_reader){.source = NULL};
}

/* Opens what a reader has a source of. */
static snow_status open_reader(tiff_reader *reader, snow_source *source) {
    reader->open = true; /* to be closed whatever the status */
    return snow_tiff_open(source, &reader->file);
}

static const char *text_of(const tiff_reader *reader) {
    char *text = NULL;
    TIFFGetField(reader->file.tiff, TIFFTAG_IMAGEDESCRIPTION, &text);
    return text;
}

/* The UUID of the element OME: the first attribute of that name. */
static void find_uuid(const char *text, char out[64]) {
    const char *at = text ? strstr(text, "OME ") : NULL;
    const char *end = at ? strchr(at, '>') : NULL;
    *out = 0;
    at = at ? strstr(at, " UUID=") : NULL;
    if (at && end && at < end)
        snprintf(out, 64, "%.*s", (int)strcspn(at + 7, "\"'>"), at + 7);
}

/* --- all files ------------------------------------------------------------ */

/* Gives a member the name of a file that has its UUID. */
static snow_status name_members(tiff_set *set, const char *name,
                                const char *uuid) {
    tiff_ome *ome = &set->ome;
    for (size_t i = 0; i < ome->member_count && *uuid; i++)
        if (!strcmp(ome->text + ome->members[i].uuid, uuid))
            SNOW_TRY(snow_tiff_keep(set->context, ome, name, strlen(name),
                                    &ome->members[i].found));
    return SNOW_STATUS_OK;
}

/* Looks which UUIDs the files of the folder have. */
static snow_status scan_folder(tiff_set *set) {
    snow_folder folder = {.paths = NULL};
    char *pattern;
    set->scanned = true;
    SNOW_TRY(snow_source_path_beside(set->own.source, "*", &pattern));
    snow_status status = snow_folder_list(set->context, pattern, &folder);
    snow_release(set->context, pattern);
    for (size_t i = 0; i < folder.count && status == SNOW_STATUS_OK; i++) {
        const char *path = folder.paths[i];
        tiff_reader reader = {.source = NULL};
        char uuid[64] = "";
        if (!snow_format_has_name(&snow_format_tiff, path))
            continue;
        if (snow_source_open(set->context, path, &reader.source) ==
                SNOW_STATUS_OK &&
            open_reader(&reader, reader.source) == SNOW_STATUS_OK)
            find_uuid(text_of(&reader), uuid);
        close_reader(&reader);
        status = name_members(set, snow_path_name(path), uuid);
    }
    if (folder.paths)
        snow_folder_free(&folder);
    return status;
}

/* Whether it is beside the file that was opened, by the name in the XML, which
 * may begin with folders of another machine. */
static snow_status find_by_name(tiff_set *set, const snow_source *beside,
                                tiff_member *member, bool *found) {
    const char *name = set->ome.text + member->name;
    const char *last = name;
    *found = false;
    for (const char *at = name; *at; at++)
        if (*at == '/' || *at == '\\')
            last = at + 1;
    if (!*last)
        return SNOW_STATUS_OK;
    SNOW_TRY(snow_source_look_for_sibling(beside, last, found));
    member->name += (size_t)(last - name);
    return SNOW_STATUS_OK;
}

static const char *own_name(const tiff_set *set) {
    return snow_path_name(snow_source_name(set->own.source));
}

/* Returns whether a member is the file that is opened. */
static bool is_own(const tiff_set *set, const tiff_member *member) {
    const char *name = set->ome.text + member->name;
    const char *uuid = set->ome.text + member->uuid;
    return set->own.open && ((*uuid && !strcmp(uuid, set->uuid)) ||
                             (*name && !strcmp(name, own_name(set))));
}

snow_status snow_tiff_find_member(tiff_set *set, size_t n) {
    tiff_member *member = &set->ome.members[n];
    const snow_source *own = set->own.source;
    bool found = false;
    if (member->state != TIFF_UNKNOWN)
        return SNOW_STATUS_OK;
    member->state = TIFF_OWN;
    if (is_own(set, member) || (!n && set->own.open && !*set->ome.elsewhere))
        return SNOW_STATUS_OK;
    member->state = TIFF_ABSENT;
    if (snow_source_has_siblings(own))
        SNOW_TRY(find_by_name(set, own, member, &found));
    if (!found && set->ome.text[member->uuid] &&
        snow_source_has_siblings(own)) {
        if (!set->scanned)
            SNOW_TRY(scan_folder(set));
        found = member->found != 0;
        member->name = found ? member->found : member->name;
        set->renamed += found;
    }
    if (found)
        member->state = TIFF_OTHER;
    /* A file that stands alone was renamed, or came without its name. */
    if (!found && set->ome.files == 1 && set->own.open && !*set->uuid) {
        member->state = TIFF_OWN;
        set->renamed++;
    }
    return SNOW_STATUS_OK;
}

/* Closes the file that was open before. */
static snow_status open_other(tiff_set *set, size_t n) {
    tiff_member *member = &set->ome.members[n];
    const char *name = set->ome.text + member->name;
    tiff_reader *other = &set->other;
    char uuid[64];
    close_reader(other);
    SNOW_TRY(snow_source_open_sibling(set->own.source, name, &other->source));
    set->number = n;
    snow_status status = open_reader(other, other->source);
    if (status == SNOW_STATUS_OK)
        status = snow_tiff_list_pages(other, true, NULL, 0);
    if (status != SNOW_STATUS_OK)
        return snow_fail_in_file(set->context, status,
                                 snow_source_name(other->source));
    member->bytes = snow_seekable_size(other->file.bytes);
    if (!member->pages &&
        TIFFSetSubDirectory(other->file.tiff, *other->pages)) {
        find_uuid(text_of(other), uuid);
        set->strange += *uuid && set->ome.text[member->uuid] &&
                        strcmp(uuid, set->ome.text + member->uuid) != 0;
    }
    member->pages = other->count;
    return SNOW_STATUS_OK;
}

snow_status snow_tiff_open_member(tiff_set *set, size_t n, tiff_reader **out) {
    tiff_member *member = &set->ome.members[n];
    SNOW_TRY(snow_tiff_find_member(set, n));
    *out = NULL;
    if (member->state == TIFF_ABSENT)
        return SNOW_STATUS_OK;
    if (member->state == TIFF_OTHER && (!set->other.open || set->number != n))
        SNOW_TRY(open_other(set, n));
    *out = member->state == TIFF_OWN ? &set->own : &set->other;
    if (member->state == TIFF_OWN) {
        member->pages = set->own.count;
        member->bytes = snow_seekable_size(set->own.file.bytes);
    }
    return SNOW_STATUS_OK;
}

/* --- the XML -------------------------------------------------------------- */

/* The number of the image that the own file has pages of, if that is another
 * than the first, which was read. */
static bool prefers(const tiff_set *set, const char *wanted, char number[24]) {
    snprintf(number, 24, "%lld", (long long)set->ome.has_own);
    return !wanted && set->ome.has_own > 0;
}

static snow_status read_text(tiff_set *set, const char *text,
                             const char *wanted) {
    snow_source *memory;
    char number[24];
    SNOW_TRY(snow_source_open_memory(set->context, "OME-XML", text,
                                     strlen(text), &memory));
    snow_status status =
        snow_tiff_read_ome(memory, wanted, own_name(set), &set->ome);
    snow_source_close(memory);
    if (status != SNOW_STATUS_OK || !prefers(set, wanted, number))
        return status;
    snow_tiff_free_ome(set->context, &set->ome);
    return read_text(set, text, number);
}

static bool is_utf8(const char *text) {
    size_t count = 1;
    bool control;
    for (; *text && count; text += count)
        count = snow_letter_bytes(text, &control);
    return count > 0;
}

/* Texts that are no UTF-8 have letters of Latin-1.  Control characters, which
 * XML has none of, become "?". */
static snow_status read_letters(tiff_set *set, const char *text,
                                const char *wanted) {
    const bool wide = !is_utf8(text);
    char *clean = snow_allocate(set->context, 2 * strlen(text) + 1);
    char *at = clean;
    if (!clean)
        return SNOW_STATUS_NO_MEMORY;
    for (const unsigned char *c = (const unsigned char *)text; *c; c++) {
        const bool latin = wide && *c >= 0x80;
        if (latin)
            *at++ = (char)(0xc0 | *c >> 6);
        *at++ = (char)(latin                               ? 0x80 | (*c & 0x3f)
                       : *c < ' ' && !strchr("\t\n\r", *c) ? '?'
                                                           : *c);
    }
    *at = 0;
    snow_status status = read_text(set, clean, wanted);
    snow_release(set->context, clean);
    return status;
}

/* The file that has the XML of this one is another of TIFF, or XML alone. */
static snow_status follow(tiff_set *set, const char *wanted) {
    char name[sizeof set->ome.elsewhere], number[24];
    unsigned char bytes[4];
    size_t got;
    snow_source *source;
    memcpy(name, set->ome.elsewhere, sizeof name);
    snow_tiff_free_ome(set->context, &set->ome);
    SNOW_TRY(snow_source_open_sibling(set->own.source, name, &source));
    tiff_reader reader = {.source = source};
    snow_status status = snow_source_peek(source, bytes, 4, &got);
    if (status == SNOW_STATUS_OK && !snow_tiff_probe(bytes, got)) {
        status = snow_tiff_read_ome(source, wanted, own_name(set), &set->ome);
    } else if (status == SNOW_STATUS_OK) {
        status = open_reader(&reader, source);
        const char *text = status == SNOW_STATUS_OK ? text_of(&reader) : NULL;
        if (status == SNOW_STATUS_OK && text)
            status = read_letters(set, text, wanted);
    }
    close_reader(&reader);
    if (status == SNOW_STATUS_OK && !set->ome.run_count)
        status =
            snow_fail(set->context, SNOW_STATUS_BAD_INPUT,
                      "%s, which should describe its planes, does not", name);
    memcpy(set->ome.elsewhere, name, sizeof name);
    if (status == SNOW_STATUS_OK && prefers(set, wanted, number))
        return follow(set, number);
    return status == SNOW_STATUS_OK
               ? snow_tiff_keep(set->context, &set->ome, name, strlen(name),
                                &set->ome.members->name)
               : status;
}

/* XML that is damaged says nothing: the pages are slices in their order. */
static snow_status read_own(tiff_set *set, const char *text,
                            const char *wanted) {
    snow_status status = read_letters(set, text, wanted);
    set->is_ome = status == SNOW_STATUS_OK;
    memcpy(set->uuid, set->ome.uuid, sizeof set->uuid);
    if (status == SNOW_STATUS_BAD_INPUT) {
        snow_notify(set->context,
                    "its OME-XML is not used, and pages are slices in their "
                    "order: %s",
                    snow_context_message(set->context));
        return SNOW_STATUS_OK;
    }
    if (set->is_ome && *set->ome.elsewhere && !set->ome.run_count)
        status = follow(set, wanted);
    return status;
}

snow_status snow_tiff_open_set(snow_source *source,
                               const snow_volume_options *options,
                               tiff_set *set) {
    const char *wanted = options->dataset ? options->dataset : options->series;
    unsigned char bytes[4];
    size_t got;
    *set = (tiff_set){.context = snow_source_context(source)};
    set->own.source = source;
    SNOW_TRY(snow_source_peek(source, bytes, sizeof bytes, &got));
    if (!snow_tiff_probe(bytes, got)) {
        set->is_ome = true;
        return snow_tiff_read_ome(source, wanted, NULL, &set->ome);
    }
    SNOW_TRY(open_reader(&set->own, source));
    const char *text = text_of(&set->own);
    if (text && (strstr(text, "<OME") || strstr(text, ":OME ")))
        SNOW_TRY(read_own(set, text, wanted));
    if (wanted && !set->is_ome)
        return snow_fail(set->context, SNOW_STATUS_BAD_USAGE,
                         "--dataset %.64s: the file has no images by name; "
                         "remove the option",
                         wanted);
    return SNOW_STATUS_OK;
}

void snow_tiff_close_set(tiff_set *set) {
    set->own.source = NULL; /* the caller's */
    close_reader(&set->own);
    close_reader(&set->other);
    snow_tiff_free_ome(set->context, &set->ome);
}

#endif
