// A Modbus device based on libmodbus, as an independent peer of the bridge.
//
//   libmodbus-server rtu PATH [BAUD [UNIT [DELAY_MS]]]     8N1; default 115200 baud, unit 1
//   libmodbus-server tcp PORT [ITEMS]                      127.0.0.1
//
// Prints READY when it serves, ends with SIGTERM. Memory, all areas 0..499 or ITEMS, equal to
// pymodbus_server.py:
//  coil n = (n % 3 == 0), input n = (n % 2 == 1), holding n = 1000 + n, input-register n = 2000 + n
#include <modbus/modbus.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace {

constexpr int kItems = 500;

modbus_mapping_t* make_memory(int items) {
  modbus_mapping_t* memory = modbus_mapping_new(items, items, items, items);
  for (int n = 0; memory != nullptr && n < items; ++n) {
    memory->tab_bits[n] = n % 3 == 0;
    memory->tab_input_bits[n] = n % 2 == 1;
    memory->tab_registers[n] = static_cast<std::uint16_t>(1000 + n);
    memory->tab_input_registers[n] = static_cast<std::uint16_t>(2000 + n);
  }
  return memory;
}

int fail(const char* what) {
  std::fprintf(stderr, "libmodbus-server: %s: %s\n", what, modbus_strerror(errno));
  return 1;
}

void ready() {
  std::puts("READY");
  std::fflush(stdout);
}

int serve_rtu(modbus_t* bus, modbus_mapping_t* memory, int delay_ms) {
  if (modbus_connect(bus) != 0) return fail("connect");
  ready();
  std::array<std::uint8_t, MODBUS_RTU_MAX_ADU_LENGTH> request;
  for (;;) {
    const int size = modbus_receive(bus, request.data());
    if (size < 0 && errno < MODBUS_ENOBASE && errno != ETIMEDOUT && errno != EINTR)
      return fail("receive");  // the port is closed
    if (size <= 0) continue;   // broken, or to another unit
    if (delay_ms > 0) ::usleep(static_cast<useconds_t>(delay_ms) * 1000);
    modbus_reply(bus, request.data(), size, memory);
  }
}

int serve_tcp(modbus_t* bus, modbus_mapping_t* memory) {
  int listener = modbus_tcp_listen(bus, 4);
  if (listener < 0) return fail("listen");
  ready();
  std::array<std::uint8_t, MODBUS_TCP_MAX_ADU_LENGTH> request;
  for (;;) {  // one master at a time
    if (modbus_tcp_accept(bus, &listener) < 0) return fail("accept");
    for (;;) {
      const int size = modbus_receive(bus, request.data());
      if (size < 0) break;
      if (size > 0) modbus_reply(bus, request.data(), size, memory);
    }
    modbus_close(bus);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const auto number = [&](int at, int otherwise) {
    return argc > at ? std::atoi(argv[at]) : otherwise;
  };
  const std::string kind = argc > 2 ? argv[1] : "";
  // libmodbus continues to wait when a signal interrupts it.
  std::signal(SIGTERM, [](int) { ::_exit(0); });
  std::signal(SIGINT, [](int) { ::_exit(0); });
  modbus_mapping_t* memory = make_memory(kind == "tcp" ? number(3, kItems) : kItems);
  if (memory == nullptr) return fail("memory");
  if (kind == "rtu") {
    modbus_t* bus = modbus_new_rtu(argv[2], number(3, 115200), 'N', 8, 1);
    if (bus == nullptr || modbus_set_slave(bus, number(4, 1)) != 0) return fail(argv[2]);
    return serve_rtu(bus, memory, number(5, 0));
  }
  if (kind == "tcp") {
    modbus_t* bus = modbus_new_tcp("127.0.0.1", number(2, 0));
    return bus == nullptr ? fail(argv[2]) : serve_tcp(bus, memory);
  }
  std::fprintf(stderr,
               "usage: libmodbus-server rtu PATH [BAUD [UNIT [DELAY_MS]]] | tcp PORT [ITEMS]\n");
  return 2;
}
