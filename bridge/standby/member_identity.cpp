#include "bridge/standby/member_identity.hpp"

#include <fmt/format.h>
#include <signal.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <string_view>
#include <type_traits>

namespace fieldcast {

namespace {

// FNV-1a of 64 bits over the texts with their terminating zeros.
class Sum {
 public:
  void add(std::string_view text) {
    for (const char c : text) add_byte(static_cast<unsigned char>(c));
    add_byte(0);
  }
  void add(std::int64_t number) { add(std::to_string(number)); }
  [[nodiscard]] std::string text() const { return fmt::format("{:016x}", sum_); }

 private:
  void add_byte(unsigned char byte) { sum_ = (sum_ ^ byte) * 1099511628211ULL; }
  std::uint64_t sum_ = 14695981039346656037ULL;
};

template <class... Parts>
void add_parts(Sum& sum, const Parts&... parts);

// Of a declaration: the parts that determine values. With other checksums, baud rates, refusals or
// rounds of the login, a member may read nothing, but no other values.
template <class Part>
void add_part(Sum& sum, const Part& part) {
  if constexpr (requires { part.begin(); }) {
    add_part(sum, part.size());
    for (const auto& each : part) add_part(sum, each);
  } else if constexpr (requires { part.has_value(); }) {
    add_part(sum, part.has_value());
    if (part) add_part(sum, *part);
  } else if constexpr (std::is_same_v<Part, TextNumber>) {
    add_parts(sum, part.kind, part.decimals, part.leading_zeros, part.plus);
  } else if constexpr (std::is_same_v<Part, declared::Word>) {
    add_parts(sum, part.notation, part.characters, part.little_endian, part.sign_bits,
              part.variable);
  } else if constexpr (std::is_same_v<Part, declared::Field>) {
    add_parts(sum, part.name, part.kind, part.word, part.bits, part.shift, part.opens,
              part.is_signed, part.counts, part.transform.add, part.transform.exor, part.variable,
              part.text_size, part.text_number, part.text, part.key, part.after, part.until,
              part.number, part.times, part.plus, part.of.from, part.of.to, part.on, part.off,
              part.packed, part.separator, part.place, part.exponent, part.sign);
  } else if constexpr (std::is_same_v<Part, declared::Frame>) {
    add_parts(sum, part.fields, part.block, part.escape, part.escaped.from, part.escaped.to);
  } else if constexpr (std::is_same_v<Part, declared::DeclaredArea>) {
    add_parts(sum, part.prefix, part.base, part.origin, part.item_bits);
  } else if constexpr (std::is_same_v<Part, declared::Operation>) {
    add_parts(sum, part.write, part.area, part.command, part.min_count, part.max_count, part.first,
              part.request, part.response, part.others, part.before);
  } else if constexpr (std::is_enum_v<Part>) {
    sum.add(static_cast<std::int64_t>(part));
  } else {
    sum.add(fmt::format("{}", part));
  }
}

template <class... Parts>
void add_parts(Sum& sum, const Parts&... parts) {
  (add_part(sum, parts), ...);
}

void add(Sum& sum, const ChannelSpec& channel) {
  const Encoding& encoding = channel.encoding;
  sum.add(channel.name);
  sum.add(channel.at);
  sum.add(static_cast<std::int64_t>(encoding.type));
  sum.add(encoding.string_bytes);
  // Of texts and numbers as text only, so that members of two versions share the sum of the others.
  if (encoding.text_number)
    sum.add(fmt::format("text {}", static_cast<int>(encoding.text_number.kind)));
  if (encoding.charset != Charset::kUtf8) sum.add(to_text(encoding.charset));
  sum.add(static_cast<std::int64_t>(encoding.word_order));
  sum.add(static_cast<std::int64_t>(encoding.byte_order));
  sum.add(encoding.bit ? *encoding.bit : -1);
  sum.add(fmt::format("{} {}", encoding.scale, encoding.offset));
  for (const std::uint64_t pattern : encoding.not_available)
    sum.add(static_cast<std::int64_t>(pattern));
  if (encoding.exponent_distance != 0)
    sum.add(fmt::format("exponent {}", encoding.exponent_distance));
  sum.add(channel.refresh.count());
  sum.add(static_cast<std::int64_t>(channel.mode));
  sum.add(static_cast<std::int64_t>(channel.access));
  sum.add(channel.on_interest ? 1 : 0);
  const Limits& limits = channel.limits;
  if (limits != Limits{})
    add_parts(sum, limits.low_low, limits.low, limits.high, limits.high_high, limits.hysteresis,
              limits.delay.count(), limits.priority);
  if (channel.write_min || channel.write_max || channel.write_interval != Duration::zero())
    add_parts(sum, channel.write_min, channel.write_max, channel.write_interval.count());
}

std::string boot() {
  std::string id;
  std::getline(std::ifstream("/proc/sys/kernel/random/boot_id"), id);
  return id;
}

std::string pid_namespace() {
  std::error_code ignored;
  // For example "pid:[402653]".
  return std::filesystem::read_symlink("/proc/self/ns/pid", ignored).string();
}

// Start time of a process in ticks after boot, from /proc/pid/stat (proc(5)): "pid (name) state ..
// starttime". Empty if it is not visible; an empty text if it has ended but was not reaped.
std::optional<std::string> start_of(const std::string& pid) {
  constexpr int kState = 3, kStartTime = 22;
  std::string line, field, state;
  std::getline(std::ifstream(fmt::format("/proc/{}/stat", pid)), line);
  const auto name_end = line.rfind(')');
  if (name_end == std::string::npos) return std::nullopt;
  std::istringstream fields(line.substr(name_end + 1));
  for (int number = kState; number <= kStartTime && fields >> field; ++number) {
    if (number == kState) state = field;
  }
  return state == "Z" || state == "X" ? std::string{} : field;
}

struct Process {
  std::string pid, start;
};

// Returns `std::nullopt` for a process on another kernel or in another namespace.
std::optional<Process> process_of(const std::string& identity) {
  const std::string here = fmt::format("{}/{}/", boot(), pid_namespace());
  if (!identity.starts_with(here)) return std::nullopt;
  const std::string process = identity.substr(here.size());
  const auto slash = process.find('/');
  if (slash == 0 || slash == std::string::npos || process.find_first_not_of("0123456789") != slash)
    return std::nullopt;
  return Process{process.substr(0, slash), process.substr(slash + 1)};
}

pid_t number_of(const Process& process) {
  return static_cast<pid_t>(std::strtol(process.pid.c_str(), nullptr, 10));
}

}  // namespace

std::string common_configuration(const BridgeSpec& spec) {
  Sum sum;
  for (const BusSpec& bus : spec.buses) {
    sum.add(bus.name);
    for (const DeviceSpec& device : bus.devices) {
      sum.add(device.name);
      sum.add(device.protocol);
      sum.add(device.link.address);
      if (!device.link.long_address.empty()) sum.add(device.link.long_address);
      for (const auto& [option, value] : device.link.options) sum.add(option + "=" + value);
      if (const auto& declaration = device.declaration.value)
        add_parts(sum, declaration->areas, declaration->operations);
      for (const ChannelSpec& channel : device.channels) add(sum, channel);
    }
  }
  return sum.text();
}

std::string own_process_identity() {
  const std::string pid = std::to_string(::getpid());
  return fmt::format("{}/{}/{}/{}", boot(), pid_namespace(), pid, start_of(pid).value_or(""));
}

bool has_ended(const std::string& identity) {
  const auto process = process_of(identity);
  if (!process) return false;
  if (const auto start = start_of(process->pid)) return *start != process->start;
  // /proc may hide the processes of other users.
  return ::kill(number_of(*process), 0) != 0 && errno == ESRCH;
}

FileDescriptor open_process(const std::string& identity) {
  const auto process = process_of(identity);
  if (!process) return {};
  FileDescriptor handle(static_cast<int>(::syscall(SYS_pidfd_open, number_of(*process), 0)));
  // The number may have been reused for another process.
  if (const auto start = start_of(process->pid); start && *start != process->start) return {};
  return handle;
}

std::string own_host_name() {
  std::array<char, 65> name{};
  (void)::gethostname(name.data(), name.size() - 1);
  return name.data();
}

}  // namespace fieldcast
