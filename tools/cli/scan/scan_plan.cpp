#include "tools/cli/scan/scan_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <set>

#include "tools/cli/text/output.hpp"

namespace fieldcast::cli {
namespace {

constexpr std::size_t kMostQuestions = 2;

constexpr Duration kProbing = std::chrono::milliseconds{8300};    // for all lines of a protocol
constexpr Duration kLeastShare = std::chrono::milliseconds{700};  // for one line
// until the first byte of a response
constexpr Duration kLeastWindow = std::chrono::milliseconds{10};
constexpr Duration kLastWindow = std::chrono::milliseconds{150};  // for the last probe

// Usual and factory settings of devices by their manuals, most common first.
constexpr std::array<LineFormat, 12> kByteFormats{{{9600, 8, Parity::kNone, 1},
                                                   {19200, 8, Parity::kEven, 1},
                                                   {9600, 8, Parity::kEven, 1},
                                                   {19200, 8, Parity::kNone, 1},
                                                   {115200, 8, Parity::kNone, 1},
                                                   {38400, 8, Parity::kNone, 1},
                                                   {57600, 8, Parity::kNone, 1},
                                                   {4800, 8, Parity::kNone, 1},
                                                   {38400, 8, Parity::kEven, 1},
                                                   {115200, 8, Parity::kEven, 1},
                                                   {9600, 8, Parity::kNone, 2},
                                                   {2400, 8, Parity::kNone, 1}}};
constexpr std::array<LineFormat, 8> kTextFormats{{{9600, 7, Parity::kEven, 1},
                                                  {9600, 7, Parity::kEven, 2},
                                                  {19200, 7, Parity::kEven, 1},
                                                  {19200, 7, Parity::kEven, 2},
                                                  {38400, 7, Parity::kEven, 2},
                                                  {115200, 7, Parity::kEven, 2},
                                                  {9600, 8, Parity::kNone, 1},
                                                  {19200, 8, Parity::kEven, 1}}};

// Links of controllers on a network, most common first. An S7-200 SMART accepts the slots of an
// S7-300 (S7NetPlus, pull request 395). The TSAPs of a LOGO! and of an S7-200 with CP 243-1 are
// those of its configuration. These are the usual ones (python-snap7, issues 6 and 103; S7NetPlus,
// pull request 395).
struct UsualLink {
  std::string_view protocol;
  std::uint16_t address;
  std::array<ProtocolOption, 3> options{};
};
constexpr UsualLink kUsualLinks[] = {
    {"s7-tcp", 1},
    {"s7-tcp", 2},
    {"s7-tcp", 0},
    {"s7-tcp", 3},
    {"s7-tcp", 2, {{{"rack", "1"}}}},
    {"s7-tcp", 0, {{{"cpu", "s7-200"}, {"tsap", "02.00"}, {"local-tsap", "03.00"}}}},
    {"s7-tcp", 0, {{{"cpu", "s7-200"}, {"tsap", "20.00"}, {"local-tsap", "10.00"}}}},
    {"s7-tcp", 0, {{{"cpu", "s7-200"}, {"tsap", "10.01"}, {"local-tsap", "10.00"}}}},
    {"s7-tcp", 0, {{{"cpu", "s7-200"}, {"tsap", "10.00"}, {"local-tsap", "10.00"}}}},
    {"mitsubishi-mc", 0},
    {"mitsubishi-mc", 0, {{{"frame", "4e"}}}},
    {"mitsubishi-mc", 0, {{{"code", "ascii"}}}},
    {"mitsubishi-mc", 0, {{{"frame", "4e"}, {"code", "ascii"}}}},
    {"omron-fins", 0},
};

bool same_format(const LineFormat& a, const LineFormat& b) {
  return a.data_bits == b.data_bits && a.parity == b.parity && a.stop_bits == b.stop_bits;
}

// Wire time of one request without the response.
Duration request_time(const ScanLine& line) {
  const auto protocol = scan_protocol(line.protocol, line.addresses.front());
  if (!protocol) return {};
  const auto questions = questions_of(line.protocol, *protocol);
  if (questions.empty()) return {};
  Bytes request;
  (void)protocol->begin(ReadRequest{{questions.front().range}}, {})->start(request);
  return line.format.characters(static_cast<double>(request.size()));
}

}  // namespace

std::unique_ptr<Protocol> scan_protocol(const ScanLine& line, std::uint16_t address) {
  if (line.options.empty()) return scan_protocol(line.protocol, address);
  auto made = line.protocol.built_in->make({.address = address, .options = line.options});
  return made ? *std::move(made) : nullptr;
}

std::unique_ptr<Protocol> scan_protocol(const NamedProtocol& named, std::uint16_t address) {
  const ProtocolEntry* entry = named.built_in;
  auto made = entry == nullptr ? declared::make(named.declaration.value, {.address = address})
              : entry->variants.empty() ? entry->make({.address = address})
                                        : entry->make(link_of(entry->variants.front(), address));
  return made ? *std::move(made) : nullptr;
}

std::unique_ptr<Protocol> scan_protocol(const NamedProtocol& named) {
  if (named.built_in == nullptr)
    return scan_protocol(named, named.declaration.value->lowest_address);
  auto made = scan_protocol(named, 1);
  return made ? std::move(made) : scan_protocol(named, 0);
}

std::vector<LineFormat> usual_formats(const NamedProtocol& protocol,
                                      std::optional<std::uint32_t> baud,
                                      const std::optional<LineFormat>& format) {
  std::vector<LineFormat> usual{protocol.factory_line()};
  if (usual.front().data_bits == 8)
    usual.insert(usual.end(), kByteFormats.begin(), kByteFormats.end());
  else
    usual.insert(usual.end(), kTextFormats.begin(), kTextFormats.end());
  // The user's settings apply even if they are unusual.
  for (LineFormat& line : usual) {
    if (baud) line.baud = *baud;
    if (format) line = {line.baud, format->data_bits, format->parity, format->stop_bits};
  }
  std::vector<LineFormat> formats;
  for (const LineFormat& line : usual) {
    const bool known = std::any_of(formats.begin(), formats.end(), [&](const LineFormat& other) {
      return other.baud == line.baud && same_format(other, line);
    });
    if (!known) formats.push_back(line);
  }
  return formats;
}

tl::expected<std::vector<std::uint16_t>, std::string> addresses_from(std::string_view text) {
  const auto fault = [&] {
    return tl::unexpected(fmt::format("addresses '{}' are not understood; write 1-32, or 1,2,10-12",
                                      printable(text)));
  };
  std::set<std::uint16_t> addresses;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (at != end) {
    std::uint16_t first = 0;
    auto read = std::from_chars(at, end, first);
    if (read.ec != std::errc{}) return fault();
    std::uint16_t last = first;
    if (read.ptr != end && *read.ptr == '-') {
      read = std::from_chars(read.ptr + 1, end, last);
      if (read.ec != std::errc{} || last < first) return fault();
    }
    for (unsigned address = first; address <= last; ++address)
      addresses.insert(static_cast<std::uint16_t>(address));
    at = read.ptr;
    if (at != end && *at++ != ',') return fault();
    if (at == end && text.back() == ',') return fault();
  }
  if (addresses.empty()) return fault();
  return std::vector<std::uint16_t>(addresses.begin(), addresses.end());
}

bool has_usual_links(const NamedProtocol& protocol) {
  return std::ranges::find(kUsualLinks, protocol.name(), &UsualLink::protocol) !=
         std::end(kUsualLinks);
}

std::vector<ScanLine> scan_lines(const NamedProtocol& protocol,
                                 const std::vector<LineFormat>& formats,
                                 const std::vector<std::uint16_t>& addresses) {
  const auto made = scan_protocol(protocol);
  if (!made) return {};
  const Traits& traits = made->traits();
  std::vector<std::uint16_t> there;
  for (const std::uint16_t address : addresses) {
    if (address >= traits.lowest_address && address <= traits.highest_address)
      there.push_back(address);
  }
  if (protocol.built_in != nullptr && protocol.built_in->one_device)
    there.assign(1, traits.lowest_address);
  std::vector<ScanLine> lines;
  for (const auto& [name, address, options] : kUsualLinks) {
    if (name != protocol.name()) continue;
    lines.push_back({protocol, formats.front(), {address}});
    for (const auto& [option, value] : options)
      if (!option.empty()) lines.back().options.emplace(option, value);
  }
  if (!lines.empty()) return lines;
  for (const LineFormat& format : formats) {
    if (!there.empty()) lines.push_back({protocol, format, there});
  }
  return lines;
}

Duration silent_scan_time(const std::vector<ScanLine>& lines, Duration timeout) {
  Duration time{};
  for (const ScanLine& line : lines) {
    const auto questions = static_cast<std::int64_t>(kMostQuestions * line.addresses.size());
    time += static_cast<std::int64_t>(kMostQuestions) * kScanRest +
            questions * (request_time(line) + timeout);
  }
  return time;
}

void plan_probes(std::vector<ScanLine>& lines) {
  std::vector<Duration> cycles;  // for each line: a request and the minimum silence after it
  Duration cycle_sum{};
  std::int64_t probes = 0;
  std::set<std::string_view> protocols;
  for (const ScanLine& line : lines) {
    const auto more = static_cast<std::int64_t>(line.addresses.size()) - 1;
    cycles.push_back(request_time(line) + silence_of(StandardSilence{}, line.format));
    cycle_sum += more * cycles.back();
    probes += more;
    protocols.insert(line.protocol.name());
  }
  const auto count = static_cast<std::int64_t>(lines.size());
  const Duration probing =
      static_cast<std::int64_t>(protocols.size()) * kProbing - count * kLastWindow;
  const Duration window = std::clamp((probing - cycle_sum) / std::max<std::int64_t>(1, probes),
                                     kLeastWindow, kLastWindow);
  const Duration share = std::max(kLeastShare, probing / std::max<std::int64_t>(1, count));
  for (std::size_t i = 0; i < lines.size(); ++i) {
    ScanLine& line = lines[i];
    const auto fitting = static_cast<std::size_t>(share / (cycles[i] + window));
    const auto first = line.addresses.begin();
    const auto end =
        first + static_cast<std::ptrdiff_t>(std::min(fitting + 1, line.addresses.size()));
    line.probes.assign(first + 1, end);
    line.probes.push_back(*first);
    line.probe_wait = silence_of(StandardSilence{}, line.format) + window;
    line.last_probe_wait = kLastWindow;
  }
}

}  // namespace fieldcast::cli
