/* threads.c - threads in a page: its helpers, workers that have the engine's
 * memory too.
 *
 * A helper waits in engine_help until there is a thread, and runs it.  A page
 * without shared memory has no helpers, so that no thread begins there.  Below
 * this is emscripten's C library; what it asks of a script is here instead. */
#include <snowglass/snowglass.h>

#include <emscripten.h>
#include <errno.h>
#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>

#define HELPERS_MOST 63
#define STACK_BYTES (1 << 20)
#define STACK_ALIGN 16

enum { FREE, CLAIMED, READY }; /* states of a helper */

static struct helper {
    _Atomic int state;
    pthread_t thread; /* while it is ready, and what it runs */
    void *(*run)(void *);
    void *argument;
} helpers[HELPERS_MOST];

static int count;

int snow_processors(void) {
    return count + 1;
}

/* A thread that can be cancelled wakes now and then to look whether it was. */
static void wait_in_one_go(void) {
    pthread_setcancelstate(PTHREAD_CANCEL_DISABLE, NULL);
}

/* The top of one more helper's stack, or NULL. */
EMSCRIPTEN_KEEPALIVE void *engine_add_helper(void) {
    wait_in_one_go();
    char *stack = count < HELPERS_MOST ? malloc(STACK_BYTES) : NULL;
    if (!stack)
        return NULL;
    count++;
    uintptr_t top = (uintptr_t)(stack + STACK_BYTES);
    return (void *)(top - top % STACK_ALIGN);
}

/* --- what emscripten has in its libraries and in no header ---------------- */

void *emscripten_tls_init(void);
void __set_thread_state(pthread_t thread, int main, int runtime, int waits);
void _emscripten_thread_exit(void *result);
void _emscripten_thread_free_data(pthread_t thread);
int emscripten_builtin_pthread_create(pthread_t *thread,
                                      const pthread_attr_t *attributes,
                                      void *(*run)(void *), void *argument);

/* --- a helper ------------------------------------------------------------- */

EMSCRIPTEN_KEEPALIVE void engine_help(int number) {
    struct helper *self = &helpers[number];
    for (;;) {
        int state = atomic_load(&self->state);
        if (state != READY) {
            __builtin_wasm_memory_atomic_wait32((int *)&self->state, state, -1);
            continue;
        }
        emscripten_tls_init();
        __set_thread_state(self->thread, 0, 0, 1);
        wait_in_one_go();
        _emscripten_thread_exit(self->run(self->argument));
        atomic_store(&self->state, FREE);
        __builtin_wasm_memory_atomic_notify((int *)&self->state, 1);
    }
}

/* --- what the C library asks for ------------------------------------------ */

static bool has_free_helper(void) {
    for (int n = 0; n < count; n++)
        if (atomic_load(&helpers[n].state) == FREE)
            return true;
    return false;
}

/* The library's own leaves memory behind where it fails. */
int pthread_create(pthread_t *thread, const pthread_attr_t *attributes,
                   void *(*run)(void *), void *argument) {
    return has_free_helper() ? emscripten_builtin_pthread_create(
                                   thread, attributes, run, argument)
                             : EAGAIN;
}

int __pthread_create_js(pthread_t thread, const pthread_attr_t *attributes,
                        void *(*run)(void *), void *argument) {
    (void)attributes;
    for (int n = 0; n < count; n++) {
        struct helper *h = &helpers[n];
        int free = FREE;
        if (!atomic_compare_exchange_strong(&h->state, &free, CLAIMED))
            continue;
        h->thread = thread;
        h->run = run;
        h->argument = argument;
        atomic_store(&h->state, READY);
        __builtin_wasm_memory_atomic_notify((int *)&h->state, 1);
        return 0;
    }
    return EAGAIN;
}

/* Threads run on their helpers' stacks. */
int _emscripten_default_pthread_stack_size(void) {
    return STACK_ALIGN;
}

/* Of one that was joined: its helper is free for another then. */
void __emscripten_thread_cleanup(pthread_t thread) {
    for (int n = 0; n < count; n++)
        while (helpers[n].thread == thread &&
               atomic_load(&helpers[n].state) == READY)
            __builtin_wasm_memory_atomic_wait32((int *)&helpers[n].state, READY,
                                                -1);
    _emscripten_thread_free_data(thread);
}

/* The page's worker may wait, as its helpers may. */
void __emscripten_init_main_thread_js(pthread_t thread) {
    __set_thread_state(thread, 0, 0, 1);
}

void emscripten_check_blocking_allowed(void) {
}

int emscripten_futex_wait(volatile void *address, uint32_t value,
                          double milliseconds) {
    int64_t most = milliseconds < INFINITY ? (int64_t)(1e6 * milliseconds) : -1;
    int done =
        __builtin_wasm_memory_atomic_wait32((int *)address, (int)value, most);
    return done == 1 ? -EWOULDBLOCK : done == 2 ? -ETIMEDOUT : 0;
}

int emscripten_futex_wake(volatile void *address, int most) {
    return (int)__builtin_wasm_memory_atomic_notify((int *)address,
                                                    (unsigned)most);
}
