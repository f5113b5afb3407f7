// Loads the configuration of fieldcast-station. Stateless functions.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "config/document/fault.hpp"
#include "config/loader/loader.hpp"
#include "core/access/login.hpp"
#include "core/model/spec.hpp"
#include "tools/forward/outlet/nats/jetstream_spec.hpp"
#include "tools/station/notify/notify_spec.hpp"
#include "tools/station/report/report_spec.hpp"

namespace fieldcast::web {

enum class LocalRole : std::uint8_t { kNone, kViewer, kOperator, kEngineer };

struct WebSpec {
  ListenSpec listen{"127.0.0.1", 8090};
  std::string certificate, key;    // paths; TLS if set
  std::vector<std::string> hosts;  // further host names of this station
  std::vector<std::string> embed;
  std::optional<LocalRole> local_role;
};

struct StationSpec {
  std::string name = "station";
  // One without a name, or several named ones; empty: no DDS domain is joined.
  std::vector<DdsSite> sites{DdsSite{}};
  // Sites whose forwarders send to NATS JetStream, in addition to `sites`.
  std::optional<forward::JetStreamSpec> stream;
  bool stream_commands = false;  // sends commands of users to these sites
  LogSpec log;
  WebSpec web;
  // `samples` has the patterns of the recorded channels; an empty list records nothing.
  std::optional<StoreSpec> store;
  std::optional<NotifySpec> notify;
  std::vector<ReportSpec> reports;
  Duration backfill = std::chrono::hours{24};  // of the record; 0: missing samples stay missing
};

using LoadedStation = tl::expected<StationSpec, std::vector<config::Fault>>;

// `listen` overrides the file. Returns all faults in the order of the text.
[[nodiscard]] LoadedStation load_station(const std::string& path,
                                         const std::optional<ListenSpec>& listen = {},
                                         config::Places* places = nullptr);
[[nodiscard]] LoadedStation load_station_text(std::string_view text, const std::string& file_name,
                                              const config::FileReader& reader,
                                              const std::optional<ListenSpec>& listen = {},
                                              config::Places* places = nullptr);

// A fault of the listen address, with the fix. Outside the loopback interface a station needs TLS
// and logins, and no role for clients without a login.
struct Exposure {
  std::string_view key;  // key of `web` with the fault
  std::string what, mend;
};
[[nodiscard]] std::vector<Exposure> exposures_of(const StationSpec& spec);

// "127.0.0.1:8090", "[::1]:8090", "127.0.0.1:0" (a free port).
[[nodiscard]] std::optional<ListenSpec> listen_from(const std::string& text);

struct DocumentedKey {
  std::string name, fallback, form, text;
};
[[nodiscard]] std::vector<DocumentedKey> documented_keys();

}  // namespace fieldcast::web
