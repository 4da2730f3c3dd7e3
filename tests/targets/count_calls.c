/* QEMU plugin: the instructions of every call of some functions, those of their callees included.
 *
 *     -plugin libcount_calls.so,out=FILE,call=ENTRY:RETURN[:RETURN...][,call=...]
 *
 * A call lasts from ENTRY to the next of its RETURN addresses. Each adds a line to FILE: the number
 * of the call= argument, from 0, and the instructions. Calls may be nested, but no function within
 * itself. Written for version 1 of QEMU's plugin interface, whose header Debian does not pack. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define EXPORT __attribute__((visibility("default")))
#define CALLS_MAX 16
#define RETURNS_MAX 16

typedef uint64_t qemu_plugin_id_t;
struct qemu_plugin_tb;
struct qemu_plugin_insn;
struct qemu_info_t;
typedef void (*translated_t)(qemu_plugin_id_t, struct qemu_plugin_tb *);
typedef void (*executed_t)(unsigned, void *);
enum { NO_REGISTERS = 0 };

extern size_t qemu_plugin_tb_n_insns(const struct qemu_plugin_tb *block);
extern struct qemu_plugin_insn *qemu_plugin_tb_get_insn(const struct qemu_plugin_tb *block,
                                                        size_t index);
extern uint64_t qemu_plugin_insn_vaddr(const struct qemu_plugin_insn *instruction);
extern void qemu_plugin_register_vcpu_tb_trans_cb(qemu_plugin_id_t id, translated_t translated);
extern void qemu_plugin_register_vcpu_insn_exec_cb(struct qemu_plugin_insn *instruction,
                                                   executed_t executed, int registers, void *data);

EXPORT int qemu_plugin_version = 1;
EXPORT int qemu_plugin_install(qemu_plugin_id_t id, const struct qemu_info_t *info, int argc,
                               char **argv);

typedef struct {
    uint64_t entry, returns[RETURNS_MAX];
    int return_count;
    uint64_t began_at;
    int running;
} call_t;

static call_t calls[CALLS_MAX];
static int call_count;
static uint64_t executed_count;
static FILE *out;

static int returns_at(const call_t *call, uint64_t address)
{
    for (int i = 0; i < call->return_count; i++) {
        if (call->returns[i] == address) {
            return 1;
        }
    }
    return 0;
}

static void on_border(unsigned cpu, void *data)
{
    (void)cpu;
    const uint64_t address = (uint64_t)(uintptr_t)data;
    for (int i = 0; i < call_count; i++) {
        call_t *call = &calls[i];
        if (call->running && returns_at(call, address)) {
            fprintf(out, "%d %llu\n", i, (unsigned long long)(executed_count - call->began_at));
            call->running = 0;
        }
        if (call->entry == address) {
            call->began_at = executed_count;
            call->running = 1;
        }
    }
}

static void on_instruction(unsigned cpu, void *data)
{
    (void)cpu;
    (void)data;
    executed_count++;
}

static int is_border(uint64_t address)
{
    for (int i = 0; i < call_count; i++) {
        if (calls[i].entry == address || returns_at(&calls[i], address)) {
            return 1;
        }
    }
    return 0;
}

static void on_translated(qemu_plugin_id_t id, struct qemu_plugin_tb *block)
{
    (void)id;
    for (size_t i = 0; i < qemu_plugin_tb_n_insns(block); i++) {
        struct qemu_plugin_insn *instruction = qemu_plugin_tb_get_insn(block, i);
        const uint64_t address = qemu_plugin_insn_vaddr(instruction);
        if (is_border(address)) {
            qemu_plugin_register_vcpu_insn_exec_cb(instruction, on_border, NO_REGISTERS,
                                                   (void *)(uintptr_t)address);
        }
        qemu_plugin_register_vcpu_insn_exec_cb(instruction, on_instruction, NO_REGISTERS, NULL);
    }
}

static void add_call(char *addresses)
{
    call_t *call = &calls[call_count++];
    call->entry = strtoull(addresses, &addresses, 0);
    while (*addresses == ':' && call->return_count < RETURNS_MAX) {
        call->returns[call->return_count++] = strtoull(addresses + 1, &addresses, 0);
    }
}

static void close_out(void)
{
    (void)fclose(out);
}

int qemu_plugin_install(qemu_plugin_id_t id, const struct qemu_info_t *info, int argc, char **argv)
{
    (void)info;
    for (int i = 0; i < argc; i++) {
        if (strncmp(argv[i], "out=", 4) == 0) {
            out = fopen(argv[i] + 4, "w");
        } else if (strncmp(argv[i], "call=", 5) == 0 && call_count < CALLS_MAX) {
            add_call(argv[i] + 5);
        }
    }
    if (out == NULL || call_count == 0 || atexit(close_out) != 0) {
        fputs("count_calls: needs out=FILE and call=ENTRY:RETURN\n", stderr);
        return 1;
    }
    qemu_plugin_register_vcpu_tb_trans_cb(id, on_translated);
    return 0;
}
