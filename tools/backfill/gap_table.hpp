// The open gaps of all channels: which of them is requested next from the store of a bridge, and
// what remains after a response. Each sample is accepted once. Pure; one owner.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bridge/dds/topics/history_values.hpp"
#include "core/base/time.hpp"
#include "tools/backfill/gap.hpp"

namespace fieldcast {

// Fetched samples of one device in one epoch, by channel, then in the order of publication.
struct Fetched {
  std::string bus, device;
  std::uint64_t epoch = 0;
  // With the name of the channel.
  std::vector<std::pair<std::string, HistoryRow>> samples;
};

class GapTable {
 public:
  // Further gaps are refused and counted.
  static constexpr std::size_t kMaxGaps = 200'000;
  // From a gap to its request: bridges write their samples in batches.
  static constexpr Duration kSettle = std::chrono::seconds{5};
  // Until then, a gap that the store does not fill completely is requested again.
  static constexpr Duration kPatience = std::chrono::seconds{30};
  // Before the next request to a bus that did not respond or refused; doubles each time.
  static constexpr Duration kRest = std::chrono::seconds{5}, kMostRest = std::chrono::minutes{1};

  // Returns false if there are too many gaps. `found`: when the gap was found.
  bool add(const Gap& gap, Instant found);

  // The next request, if one is due: for one bus, without requester and id.
  [[nodiscard]] std::optional<HistoryRequest> next(Instant now) const;

  struct Progress {
    std::vector<Fetched> fetched;
    std::vector<GapChange> changes;
    std::uint64_t samples = 0;
    std::string refusal;  // why gaps were closed without their samples; empty: they were not
  };
  // The response to the last request of next().
  [[nodiscard]] Progress on_response(const HistoryRequest& request, HistoryResponse response,
                                     Instant now);
  // There was no response.
  void on_failure(const std::string& bus, Instant now);

  [[nodiscard]] std::size_t size() const { return size_; }  // open gaps
  [[nodiscard]] bool has(const std::string& bus) const { return buses_.contains(bus); }

 private:
  struct Open {
    SampleNumber after;
    UtcTime since;
    Instant found{};
    Instant due{};
  };
  struct Bus {
    // By path, then by the end of the gap.
    std::map<std::string, std::map<SampleNumber, Open>> channels;
    Instant due{};
    Duration rest{};  // zero: the last request was served
  };

  void close(Bus& bus, const std::string& path, const SampleNumber& until);
  // Moves the begin of a gap to the row. Returns false if it is not in the gap.
  [[nodiscard]] static bool accept(const HistoryRow& row, const SampleNumber& until, Open& open);
  // Adds the rows of the response, and moves the begin of their gaps.
  void accept(const HistoryRequest& request, std::vector<HistoryRow> rows, Bus& bus,
              Progress& progress);

  std::map<std::string, Bus> buses_;
  std::size_t size_ = 0;
};

}  // namespace fieldcast
