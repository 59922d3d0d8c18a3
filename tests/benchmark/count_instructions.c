// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// Plugin of QEMU's user mode that counts the instructions which a program runs in all, or, with symbols=on, in each
// function of the program itself. Exact for a program of one thread. Loaded by tests/benchmark/instructions.py.
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// What is used of qemu-plugin.h, version 1, which Debian does not ship.
typedef uint64_t qemu_plugin_id_t;
struct qemu_info_t;
struct qemu_plugin_tb;
struct qemu_plugin_insn;
enum qemu_plugin_op { QEMU_PLUGIN_INLINE_ADD_U64 };
typedef void (*qemu_plugin_vcpu_tb_trans_cb_t)(qemu_plugin_id_t, struct qemu_plugin_tb*);
typedef void (*qemu_plugin_udata_cb_t)(qemu_plugin_id_t, void*);
void qemu_plugin_register_vcpu_tb_trans_cb(qemu_plugin_id_t, qemu_plugin_vcpu_tb_trans_cb_t);
void qemu_plugin_register_vcpu_tb_exec_inline(struct qemu_plugin_tb*, enum qemu_plugin_op, void*, uint64_t);
void qemu_plugin_register_atexit_cb(qemu_plugin_id_t, qemu_plugin_udata_cb_t, void*);
size_t qemu_plugin_tb_n_insns(const struct qemu_plugin_tb*);
struct qemu_plugin_insn* qemu_plugin_tb_get_insn(const struct qemu_plugin_tb*, size_t);
const char* qemu_plugin_insn_symbol(const struct qemu_plugin_insn*);
void qemu_plugin_outs(const char*);

__attribute__((visibility("default"))) int qemu_plugin_version = 1;

struct symbol {
  const char* name;
  uint64_t count;
};
enum { kMostSymbols = 1 << 16 };
static struct symbol* symbols;  // a hash table; its last entry counts what has no name
static int by_symbol;

static struct symbol* counter_of(const char* name) {
  if (!by_symbol || name == NULL) return &symbols[kMostSymbols];
  uint64_t hash = 14695981039346656037U;
  for (const char* c = name; *c != '\0'; ++c) hash = (hash ^ (unsigned char)*c) * 1099511628211U;
  for (uint64_t i = 0; i < kMostSymbols; ++i) {
    struct symbol* s = &symbols[(hash + i) % kMostSymbols];
    if (s->name == NULL) s->name = strdup(name);
    if (strcmp(s->name, name) == 0) return s;
  }
  return &symbols[kMostSymbols];
}

static void translated(qemu_plugin_id_t id, struct qemu_plugin_tb* block) {
  (void)id;
  const size_t count = qemu_plugin_tb_n_insns(block);
  struct symbol* counter = counter_of(qemu_plugin_insn_symbol(qemu_plugin_tb_get_insn(block, 0)));
  qemu_plugin_register_vcpu_tb_exec_inline(block, QEMU_PLUGIN_INLINE_ADD_U64, &counter->count, count);
}

static void ended(qemu_plugin_id_t id, void* data) {
  (void)id;
  (void)data;
  char line[1024];
  uint64_t total = 0;
  for (int i = 0; i <= kMostSymbols; ++i) {
    total += symbols[i].count;
    if (!by_symbol || symbols[i].count == 0) continue;
    snprintf(line, sizeof line, "%" PRIu64 " %s\n", symbols[i].count, symbols[i].name ? symbols[i].name : "-");
    qemu_plugin_outs(line);
  }
  snprintf(line, sizeof line, "%" PRIu64 " instructions\n", total);
  qemu_plugin_outs(line);
}

__attribute__((visibility("default"))) int qemu_plugin_install(qemu_plugin_id_t id, const struct qemu_info_t* info,
                                                               int argc, char** argv) {
  (void)info;
  for (int i = 0; i < argc; ++i) by_symbol |= strcmp(argv[i], "symbols=on") == 0;
  symbols = calloc(kMostSymbols + 1, sizeof *symbols);
  if (symbols == NULL) return 1;
  qemu_plugin_register_vcpu_tb_trans_cb(id, translated);
  qemu_plugin_register_atexit_cb(id, ended, NULL);
  return 0;
}
