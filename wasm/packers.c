/* packers.c - what c-blosc calls to pack, in the place of the packers: the page
 * only unpacks (wasm/CMakeLists.txt). */
#include <lz4hc.h>
#include <stddef.h>
#include <zlib.h>
#include <zstd.h>

int no_blosclz(int level, const void *from, int size, void *to, int room,
               int split);
int no_lz4(const char *from, char *to, int size, int room, int speed);

int no_blosclz(int level, const void *from, int size, void *to, int room,
               int split) {
    (void)level, (void)from, (void)size, (void)to, (void)room, (void)split;
    return 0;
}

int no_lz4(const char *from, char *to, int size, int room, int speed) {
    (void)from, (void)to, (void)size, (void)room, (void)speed;
    return 0;
}

int LZ4_compress_HC(const char *from, char *to, int size, int room, int level) {
    return no_lz4(from, to, size, room, level);
}

size_t ZSTD_compress(void *to, size_t room, const void *from, size_t size,
                     int level) {
    (void)to, (void)room, (void)from, (void)size, (void)level;
    return 0;
}

int ZSTD_maxCLevel(void) {
    return 0;
}

int compress2(Bytef *to, uLongf *room, const Bytef *from, uLong size,
              int level) {
    (void)to, (void)room, (void)from, (void)size, (void)level;
    return Z_MEM_ERROR;
}
