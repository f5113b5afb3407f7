// Compares the trie of core/codec/lzw with a simple encoder whose dictionary is a std::map of
// strings. Both run on the same messages; the codes are checked to be equal.
//
// usage: lzw_bench [seconds of each measurement, 0.3]
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <random>
#include <vector>

#include "core/codec/lzw.hpp"
#include "core/protocol/dtc/packet.hpp"
#include "tests/core/lzw_reference.hpp"
#include "tools/bench/support/arguments.hpp"
#include "tools/bench/support/figures.hpp"
#include "tools/progress/progress_line.hpp"

namespace {

using namespace fieldcast;
using bench::Clock;

enum class Kind { kIdle, kSlow, kRandom };
constexpr const char* kNames[] = {"idle (few values, mostly zero)", "slowly changing registers",
                                  "random"};

std::vector<Bytes> messages(Kind kind, std::size_t length) {
  std::mt19937 random(1);
  std::vector<Bytes> all;
  std::vector<unsigned> registers(length / 2);
  for (auto& value : registers) value = 200u + static_cast<unsigned>(random() % 50);
  for (int n = 0; n < 64; ++n) {
    Bytes bytes;
    for (auto& value : registers) {
      if (kind == Kind::kIdle) value = random() % 16 == 0 ? 100u : 0u;
      if (kind == Kind::kSlow) value += static_cast<unsigned>(random() % 3) - 1;
      if (kind == Kind::kRandom) value = static_cast<unsigned>(random());
      append_u16(bytes, static_cast<std::uint16_t>(value));
    }
    all.push_back(std::move(bytes));
  }
  return all;
}

struct Course {
  double seconds;
  StepProgress& progress;
};

// The best of the rounds in megabytes a second, because other processes share the machine.
double rate(std::size_t bytes, const Course& course, const std::function<void()>& work) {
  double best = 0;
  const auto end = Clock::now() + std::chrono::duration<double>(course.seconds);
  do {
    const auto start = Clock::now();
    work();
    best = std::max(best, static_cast<double>(bytes) / bench::seconds_since(start) / 1e6);
  } while (Clock::now() < end);
  course.progress.step();
  return best;
}

volatile std::size_t g_sink = 0;

void compare(Kind kind, std::size_t length, const Course& course) {
  const auto all = messages(kind, length);
  LzwEncoder encoder;
  Bytes out(3 * length + 16), expanded;
  std::size_t plain = 0, packed = 0;
  for (const Bytes& each : all) {
    const auto size = encoder.encode(each, out);
    if (!size || Bytes(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(*size)) !=
                     test::packed(test::reference_codes(each))) {
      std::puts("the two encoders differ");
      std::exit(1);
    }
    Bytes packet;
    dtc::append_packet(packet, each, 0);
    if (packet.size() > dtc::kPacketHead + each.size()) {
      std::puts("a packet is longer than the plain one");
      std::exit(1);
    }
    plain += dtc::kPacketHead + each.size();
    packed += packet.size();
  }
  const std::size_t bytes = all.size() * length;
  const double trie = rate(bytes, course, [&] {
    for (const Bytes& each : all) g_sink = *encoder.encode(each, out);
  });
  // The reference makes only codes; our encoder also packs them.
  const double strings = rate(bytes, course, [&] {
    for (const Bytes& each : all) g_sink = test::reference_codes(each).size();
  });
  std::vector<Bytes> codes;
  for (const Bytes& each : all)
    codes.emplace_back(out.begin(),
                       out.begin() + static_cast<std::ptrdiff_t>(*encoder.encode(each, out)));
  const double back = rate(bytes, course, [&] {
    for (const Bytes& each : codes) {
      expanded.clear();
      if (!lzw_decode(each, length, expanded) || expanded.size() != length) std::exit(1);
    }
  });
  course.progress.clear();

  std::printf("\n%s, messages of %zu bytes; packets are %.2f of the plain ones, none is longer\n",
              kNames[static_cast<int>(kind)], length,
              static_cast<double>(packed) / static_cast<double>(plain));
  bench::print_figure("  trie encoder", trie, "MB/s", "goal: above 50");
  bench::print_figure("  std::map of strings", strings, "MB/s");
  bench::print_figure("  trie / strings", trie / strings, "times", "goal: at least 5");
  bench::print_figure("  decoder", back, "MB/s");
}

}  // namespace

int main(int argc, char** argv) {
  const double seconds = bench::Arguments(argc, argv).number_at(0, 0.3);
  constexpr std::size_t kMeasurements = 3 * 3 * 3;  // kinds, lengths, and what is timed
  StepProgress progress("measuring", kMeasurements);
  const Course course{seconds, progress};
  for (const Kind kind : {Kind::kIdle, Kind::kSlow, Kind::kRandom}) {
    for (const std::size_t length : {64u, 1024u, 4096u}) compare(kind, length, course);
  }
}
