// Fetches samples that the recorder did not receive from the stores of bridges, on its own thread
// at low priority. It begins after a start with the last stored sample of each channel. Not kept
// over a restart: a gap that is open then stays in the record.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "bridge/base/worker.hpp"
#include "bridge/station/station.hpp"
#include "bridge/store/records/records.hpp"
#include "bridge/store/sql/sql.hpp"
#include "bridge/store/tiers/sample_table.hpp"
#include "tools/backfill/gap_table.hpp"
#include "tools/station/record/recorder.hpp"

namespace fieldcast::web {

struct BackfillSpec {
  StoreAddress store;
  Duration longest{};  // older samples are not requested; 0: nothing is fetched
};

class BackFiller {
 public:
  // Borrows both, and calls recorder.watch_gaps().
  BackFiller(BackfillSpec spec, Station& station, Recorder& recorder);
  ~BackFiller() { worker_.close(); }
  BackFiller(const BackFiller&) = delete;
  BackFiller& operator=(const BackFiller&) = delete;

 private:
  static constexpr Duration kLook = std::chrono::seconds{1};
  // Between two requests while the store has many samples to write.
  static constexpr Duration kBusy = std::chrono::milliseconds{50};

  struct Filled {
    std::uint64_t samples = 0;
    UtcTime from, to;
  };

  void run(BoundedQueue<int>& commands);
  void look();
  // Looks up the last stored sample before the first one of this run. Throws StoreError.
  void open(const FirstSample& first);
  void add(Gap gap);
  [[nodiscard]] bool fetch_part();
  void record(const Fetched& fetched);
  void report(const std::string& bus);

  const BackfillSpec spec_;
  Station& station_;
  Recorder& recorder_;
  std::unique_ptr<SqlConnection> connection_;
  GapTable gaps_;
  std::vector<FirstSample> first_;              // not looked up yet
  std::map<std::string, SampleRow> stored_;     // by path: the stored sample before a gap
  std::map<std::string, Filled> filled_;        // by bus
  std::map<std::string, std::string> refused_;  // by bus: the reason, which is logged once
  bool is_right_reported_ = false;              // that this station may not fetch samples
  Worker<int> worker_;                          // last: it uses the members above
};

}  // namespace fieldcast::web
