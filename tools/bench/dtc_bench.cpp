// Compares DTC with Modbus RTU on the same scattered channels: wire time of one round of all
// channels, each with its best partition.
//
// Uses the registers of tests/maps, as Modbus holding registers and as DTC int16 variables. Modbus:
// the optimal partition of core/plan. DTC: the best requests of tests/schedule. Both need 11 bits a
// character, 2 ms of the device for each request, and the silence of the maps' model: 3.5
// characters before and after a response (tests/plan/maps.hpp). A second table uses the bridge's
// default silence. Compressed figures are of real packets over many rounds of data, with the
// protocol's threshold for the line; the device compresses by the same rule.
#include <algorithm>
#include <cstdio>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "core/codec/checksum.hpp"
#include "core/plan/layout/partition.hpp"
#include "core/protocol/dtc/packet.hpp"
#include "core/protocol/families/registry.hpp"
#include "tests/plan/best_requests.hpp"
#include "tests/plan/maps.hpp"
#include "tools/bench/support/figures.hpp"

namespace {

using namespace fieldcast;

constexpr Duration kResponseTime = std::chrono::milliseconds{2};
constexpr AreaIndex kHolding = 2, kInt16 = 1;
constexpr int kRounds = 50;  // rounds of data, for compressed figures

enum class Data { kIdle, kSlow, kLevels, kRandom };
constexpr const char* kDataNames[] = {"idle", "slowly changing", "any levels", "random"};

using Units = std::map<unsigned, std::vector<std::uint32_t>>;  // ascending addresses by unit
Units units_of(const test::Map& map) {
  Units units;
  for (const test::MapRow& row : map) units[row.unit].push_back(row.address);
  for (auto& [unit, addresses] : units) std::ranges::sort(addresses);
  return units;
}

struct Wire {
  LineFormat line;
  SilenceRule rule = CharacterSilence{7};
  [[nodiscard]] Duration silence() const { return silence_of(rule, line); }
  [[nodiscard]] Duration time(std::size_t characters) const {
    return line.characters(static_cast<double>(characters)) + kResponseTime + silence();
  }
};

Duration modbus_round(const Units& units, const Wire& wire) {
  const auto protocol = *find_protocol("modbus-rtu")->make({.address = 1});
  const DeviceTiming timing{.protocol = protocol.get(), .response_time = kResponseTime};
  Duration sum{};
  for (const auto& [unit, addresses] : units) {
    std::vector<Wanted> wanted;
    for (const auto address : addresses) wanted.push_back({address, address + 1});
    const ReadCost cost(timing, kHolding, wire.line, wire.silence(), 125);
    sum += cost_of(wanted, optimal_partition(wanted, cost), cost);
  }
  return sum;
}

std::vector<ReadRequest> dtc_requests(const Protocol& protocol,
                                      const std::vector<std::uint32_t>& addresses,
                                      const Wire& wire) {
  std::vector<Range> wanted;
  for (const auto address : addresses) wanted.push_back({kInt16, address, 1});
  const DeviceTiming timing{.protocol = &protocol, .response_time = kResponseTime};
  return test::best_requests(wanted, ListCost(timing, wire.line, wire.silence())).requests;
}

// Registers of the plant over the rounds. Idle: one in ten is 1, the others 0. Slowly changing:
// temperatures of 20.0 to 25.0 degrees in tenths, one in four drifts by a tenth each round. Any
// levels: the same drift around 0..1000, where LZW finds nothing in one message. Random: all bits.
class Registers {
 public:
  explicit Registers(Data data) : data_(data) {}
  void next_round() {
    for (auto& [address, value] : values_) {
      const bool drifts = data_ == Data::kSlow || data_ == Data::kLevels;
      if (drifts && random_() % 4 == 0)
        value = static_cast<std::uint16_t>(value + random_() % 3 - 1);
      if (data_ == Data::kRandom) value = static_cast<std::uint16_t>(random_());
    }
  }
  std::uint16_t read(std::uint32_t address) {
    const auto [at, fresh] = values_.try_emplace(address);
    if (fresh) {
      switch (data_) {
        case Data::kIdle: at->second = random_() % 10 == 0 ? 1 : 0; break;
        case Data::kSlow: at->second = static_cast<std::uint16_t>(200 + random_() % 51); break;
        case Data::kLevels: at->second = static_cast<std::uint16_t>(random_() % 1001); break;
        case Data::kRandom: at->second = static_cast<std::uint16_t>(random_()); break;
      }
    }
    return at->second;
  }

 private:
  Data data_;
  std::mt19937 random_{42};
  std::map<std::uint32_t, std::uint16_t> values_;
};

Bytes response_to(const ReadRequest& request, Registers& registers) {
  Bytes message{1, 0};
  for (const Range& range : request.ranges) {
    for (std::uint32_t address = range.first; address < range.end(); ++address)
      append_u16(message, registers.read(address));
  }
  append_crc16(message);
  return message;
}

struct Round {
  double time = 0;  // seconds on the wire
  double request_bytes = 0, response_bytes = 0, requests = 0;
};

// Without `data`: uncompressed packets with the protocol's sizes.
Round dtc_round(const Units& units, const Wire& wire, std::optional<Data> data) {
  DeviceLink link{.address = 1, .line = wire.line};
  if (!data) link.options["threshold"] = "65535";
  const auto protocol = *find_protocol("dtc")->make(link);
  const std::size_t threshold = dtc::auto_threshold(wire.line, std::chrono::microseconds{1});
  Round sum;
  for (const auto& [unit, addresses] : units) {
    for (const ReadRequest& request : dtc_requests(*protocol, addresses, wire)) {
      Registers registers(data.value_or(Data::kIdle));
      Bytes sent;
      (void)protocol->begin(request, {})->start(sent);
      for (int round = 0; round < kRounds; ++round) {
        Bytes response;
        dtc::append_packet(response, response_to(request, registers),
                           data ? threshold : dtc::kNever);
        sum.time += to_seconds(wire.time(sent.size() + response.size())) / kRounds;
        sum.response_bytes += static_cast<double>(response.size()) / kRounds;
        registers.next_round();
      }
      sum.request_bytes += static_cast<double>(sent.size());
      ++sum.requests;
    }
  }
  return sum;
}

using Ratios = std::map<std::string, std::vector<double>>;

void compare(const std::string& name, const Units& units, const Wire& wire, Ratios& ratios) {
  const double modbus = to_seconds(modbus_round(units, wire));
  std::printf("%s at %u baud: Modbus RTU %.1f ms\n", name.c_str(), wire.line.baud, modbus * 1e3);
  const auto print = [&](const std::string& what, const Round& round) {
    std::printf("  dtc %-28s %7.1f ms  %.3f of Modbus  (%.0f requests, %.0f + %.0f bytes)\n",
                what.c_str(), round.time * 1e3, round.time / modbus, round.requests,
                round.request_bytes, round.response_bytes);
    ratios[std::to_string(wire.line.baud) + " " + what].push_back(round.time / modbus);
  };
  print("plain", dtc_round(units, wire, std::nullopt));
  for (const Data data : {Data::kIdle, Data::kSlow, Data::kLevels, Data::kRandom}) {
    print(std::string("compressed, ") + kDataNames[static_cast<int>(data)],
          dtc_round(units, wire, data));
  }
}

void run(const char* what, const SilenceRule& silence, bool goals) {
  std::printf("== %s\n", what);
  Ratios ratios;
  for (const std::uint32_t baud : {115200u, 9600u}) {
    for (const int number : {11, 12, 13, 14}) {
      const std::string name = "map" + std::to_string(number);
      compare(name, units_of(test::read_map(FIELDCAST_MAPS "/" + name + ".csv")),
              {{.baud = baud}, silence}, ratios);
    }
  }
  std::puts("worst of the maps, of Modbus RTU");
  const std::map<std::string, const char*> held{
      {"115200 plain", "goal: at most 0.55"},
      {"9600 plain", "goal: at most 0.68"},
      {"115200 compressed, slowly changing", "goal: at most 0.45"}};
  for (const auto& [name, values] : ratios) {
    const auto goal = held.find(name);
    const double worst = *std::ranges::max_element(values);
    bench::print_figure(name, worst, "", goals && goal != held.end() ? goal->second : "");
  }
  std::puts("");
}

}  // namespace

int main() {
  run("3.5 characters of silence on both sides of a response", CharacterSilence{7}, true);
  run("the bridge's standard silence after a response", StandardSilence{}, false);
}
