// The seam between the sender and a message engine: an outlet sends records and reports each
// acknowledgement or failure. One class and one section of the configuration for each engine.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/base/time.hpp"
#include "tools/forward/batch/record.hpp"
#include "tools/forward/outlet/site_status.hpp"
#include "tools/forward/payload/record_payload.hpp"

namespace fieldcast::forward {

// A request of the centre to write a channel (tools/forward/command).
struct CentreRequest {
  std::string user;  // verified by the permissions of the engine
  std::string text;
  // Any thread; at most once. Without effect after the outlet has ended.
  std::function<void(std::string response)> reply;
};

// Whether a bridge announces channels of the device. Any thread.
using IsAnnounced = std::function<bool(const std::string& bus, const std::string& device)>;

// What every outlet needs.
struct OutletContext {
  std::string site;
  PayloadSpec payload;
  RecordDecoder::FindCatalogue catalogue;
  std::uint32_t in_flight = 256;  // the most records without a result
  // Wakes the sender: there are results, or the connection has changed. Any thread.
  std::function<void()> wake;
  // Counts the connections of this outlet, also over restarts: 0, 1, .. Throws StoreError.
  std::function<std::uint64_t()> count_connection;
  IsAnnounced is_announced;
  // Called on a thread of the engine's library; must not block. Null: no commands are accepted.
  std::function<void(CentreRequest request)> on_command;
};

enum class Outcome : std::uint8_t {
  kAcknowledged,
  kFailed,   // not stored, or unknown: the record must be sent again
  kRefused,  // the engine refuses it every time, for example because it is too large
};

struct OutletResult {
  std::uint64_t record = 0;
  Outcome outcome = Outcome::kFailed;
};

// Used by one thread. The result of a record comes once, in any order. An outlet logs the reason of
// each failure and refusal.
class Outlet {
 public:
  virtual ~Outlet() = default;
  // Connects if necessary. Returns true if records can be sent. May block for a few seconds.
  [[nodiscard]] virtual bool is_ready(Instant now) = 0;
  // Returns the size of the message in bytes. Empty if it was not sent; then there is no result,
  // and the record is sent again later. The lane of `record` has no other record without a result.
  [[nodiscard]] virtual std::optional<std::size_t> send(const Record& record) = 0;
  // Called after the records of a turn were sent: an engine with transactions commits here. May
  // block for a few seconds.
  virtual void flush() {}
  // Publishes the state of this site, if the engine has a place for it. Called each ten seconds
  // while the outlet is ready. There is no result.
  virtual void report(const SiteStatus& /*status*/) {}
  [[nodiscard]] virtual std::vector<OutletResult> take_results() = 0;
};

}  // namespace fieldcast::forward
