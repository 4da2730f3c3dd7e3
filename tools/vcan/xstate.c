/**
 * For LD_PRELOAD with Debian's User Mode Linux 6.1. It keeps the extended state of a processor in
 * 2696 bytes, enough up to AVX-512. Where a processor has more (AMX), the kernel refuses to set a
 * part of it, and the guest dies at its start ("ptrace set fp regs failed, errno = 14"). Here a
 * state that is cut short is completed by what the process has in the rest.
 */
#define _GNU_SOURCE
#include <cpuid.h>
#include <dlfcn.h>
#include <elf.h>
#include <stdarg.h>
#include <stdint.h>
#include <string.h>
#include <sys/ptrace.h>
#include <sys/uio.h>

#define STATE_MAX 65536
#define COMPONENTS_AT 512 /* the header's bit set of the components that are in use */
#define XSAVE_LEAF 0xD
#define FIRST_EXTENDED 2 /* x87 and SSE lie before the header */

typedef long ptrace_t(enum __ptrace_request request, pid_t pid, void *address, void *data);

/** The components that lie in the first `size` bytes. Asked once: always the same size comes, and a
 *  virtual machine is slow to answer. */
static uint64_t components_within(size_t size)
{
    static uint64_t set;
    if (set != 0) {
        return set;
    }
    set = (1u << FIRST_EXTENDED) - 1;
    for (unsigned component = FIRST_EXTENDED; component < 63; ++component) {
        unsigned length, offset, flags, none;
        __cpuid_count(XSAVE_LEAF, component, length, offset, flags, none);
        if (length != 0 && offset + length <= size) {
            set |= (uint64_t)1 << component;
        }
    }
    return set;
}

static long set_state(ptrace_t *real, pid_t pid, const struct iovec *part)
{
    static __thread uint8_t state[STATE_MAX];
    struct iovec whole = {state, sizeof state};
    void *const type = (void *)(uintptr_t)NT_X86_XSTATE;
    if (real(PTRACE_GETREGSET, pid, type, &whole) < 0) {
        return -1;
    }
    uint64_t kept, given;
    const size_t size = part->iov_len < whole.iov_len ? part->iov_len : whole.iov_len;
    const uint64_t within = components_within(size);
    memcpy(&kept, state + COMPONENTS_AT, sizeof kept);
    memcpy(state, part->iov_base, size);
    memcpy(&given, state + COMPONENTS_AT, sizeof given);
    given = (given & within) | (kept & ~within);
    memcpy(state + COMPONENTS_AT, &given, sizeof given);
    return real(PTRACE_SETREGSET, pid, type, &whole);
}

long ptrace(enum __ptrace_request request, ...)
{
    va_list arguments;
    va_start(arguments, request);
    const pid_t pid = va_arg(arguments, pid_t);
    void *const address = va_arg(arguments, void *);
    void *const data = va_arg(arguments, void *);
    va_end(arguments);
    ptrace_t *const real = (ptrace_t *)dlsym(RTLD_NEXT, "ptrace");
    if (request == PTRACE_SETREGSET && (uintptr_t)address == NT_X86_XSTATE) {
        return set_state(real, pid, data);
    }
    return real(request, pid, address, data);
}
