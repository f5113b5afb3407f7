// Sends hostile datagrams to the guard. With --library it also sends the accepted ones to a real
// participant of Fieldcast in this process, over UDP on the loopback.
//
// usage: rtps_campaign --datagrams N --seed S [--library]
//
// Prints the counts by cause, the rate and the memory. Exits with 1 if the participant no longer
// receives the samples of an honest writer, or if memory grows by more than 256 MB.
#include <cstdlib>
#include <cstring>

#include "tests/bridge/dds/transport/recorded_datagrams.hpp"
#include "tests/campaign/attacked_domain.hpp"
#include "tests/campaign/rtps_mutation.hpp"

namespace fieldcast {
namespace {

using Clock = std::chrono::steady_clock;
using testing::AttackedDomain;
using testing::Datagram;

constexpr std::uint64_t kBetweenChecks = 500'000;  // datagrams
constexpr double kMostGrowth = 256;                // megabytes
constexpr std::uint32_t kDomain = 97;
// Sender address that the participant sees: 127.0.0.1.
constexpr DatagramGuard::Address kLoopback{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 127, 0, 0, 1};

struct Options {
  std::uint64_t datagrams = 1'000'000, seed = 1;
  bool library = false;
};

Options options_of(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const bool has_value = i + 1 < argc;
    if (std::strcmp(argv[i], "--library") == 0) {
      options.library = true;
    } else if (has_value && std::strcmp(argv[i], "--datagrams") == 0) {
      options.datagrams = std::strtoull(argv[++i], nullptr, 10);
    } else if (has_value && std::strcmp(argv[i], "--seed") == 0) {
      options.seed = std::strtoull(argv[++i], nullptr, 10);
    } else {
      std::fprintf(stderr, "usage: rtps_campaign --datagrams N --seed S [--library]\n");
      std::exit(2);
    }
  }
  return options;
}

// Returns handmade valid datagrams and recorded ones of Cyclone DDS, in the name of the writer
// that is matched with the participant.
std::vector<Datagram> corpus_of(const AttackedDomain* attacked) {
  std::vector<Datagram> all = testing::recorded_datagrams();
  if (all.empty()) {
    std::fprintf(stderr, "cannot read %s\n", FIELDCAST_RECORDED_DATAGRAMS);
    std::exit(1);
  }
  for (const auto& [name, bytes] : testing::valid_datagrams()) all.push_back(bytes);
  if (attacked == nullptr) return all;
  for (Datagram& one : all) {
    ParticipantPrefix sender{};
    std::copy_n(one.begin() + 8, sender.size(), sender.begin());
    // Replaces each occurrence of the names, since GUIDs contain the sender too.
    const auto replace = [&](const auto& from, const auto& to) {
      for (auto at = one.begin();;) {
        at = std::search(at, one.end(), from.begin(), from.end());
        if (at == one.end()) return;
        at = std::copy(to.begin(), to.end(), at);
      }
    };
    replace(sender, attacked->forged_sender());
    replace(testing::kSamplesReader, attacked->reader_entity());
    replace(testing::kSamplesWriter, attacked->forged_entity());
  }
  return all;
}

int run(const Options& options) {
  std::unique_ptr<AttackedDomain> attacked;
  if (options.library) {
    DdsSpec spec;
    spec.domain = kDomain;
    attacked = std::make_unique<AttackedDomain>(spec);
    if (!attacked->is_ready()) return std::fprintf(stderr, "no discovery within 10 s\n"), 1;
  }
  testing::RtpsMutation mutation(corpus_of(attacked.get()), options.seed);
  DatagramGuard guard{RtpsLimits{}};
  Datagram scratch;
  std::uint64_t accepted = 0, sent = 0;
  RtpsFaultCounts refused{};
  const auto start = Clock::now();
  const double at_start = testing::resident_megabytes();
  bool is_well = true;
  for (std::uint64_t n = 1; n <= options.datagrams && is_well; ++n) {
    const Datagram one = mutation.next();
    const Instant now{Clock::now().time_since_epoch()};
    const auto verdict = guard.check(one, kLoopback, now, scratch);
    if (verdict.fault) {
      ++refused[static_cast<std::size_t>(*verdict.fault)];
    } else {
      ++accepted;
      // The participant's own guard checks again and makes the same changes. A pause after each
      // group keeps its socket buffer from overflowing.
      if (attacked != nullptr) {
        attacked->send(one, n % 2 == 0);
        if (++sent % 32 == 0) std::this_thread::sleep_for(std::chrono::microseconds{200});
      }
    }
    if (n % kBetweenChecks != 0 && n != options.datagrams) continue;
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    const double memory = testing::resident_megabytes();
    const bool answers = attacked == nullptr || attacked->answers();
    std::printf("%llu datagrams, %llu accepted, %llu sent, %.0f a second, %.1f MB, %s\n",
                static_cast<unsigned long long>(n), static_cast<unsigned long long>(accepted),
                static_cast<unsigned long long>(sent), static_cast<double>(n) / seconds, memory,
                answers ? "receives" : "RECEIVES NO MORE");
    std::fflush(stdout);
    is_well = answers && memory - at_start < kMostGrowth;
  }
  for (std::size_t i = 0; i < kRtpsFaults; ++i)
    std::printf("%-16s %12llu\n", std::string(to_text(static_cast<RtpsFault>(i))).c_str(),
                static_cast<unsigned long long>(refused[i]));
  return is_well ? 0 : 1;
}

}  // namespace
}  // namespace fieldcast

int main(int argc, char** argv) { return fieldcast::run(fieldcast::options_of(argc, argv)); }
