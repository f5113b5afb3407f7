#include "config/sections/bridge_keys.hpp"

#include <fmt/format.h>

#include "config/document/limits.hpp"
#include "config/document/scalars.hpp"
#include "config/sections/dds.hpp"
#include "config/sections/port.hpp"
#include "config/sections/program.hpp"
#include "config/sections/store.hpp"

namespace fieldcast::config {
namespace {

constexpr std::pair<std::string_view, LogLevel> kLevels[] = {{"error", LogLevel::kError},
                                                             {"warning", LogLevel::kWarning},
                                                             {"info", LogLevel::kInfo},
                                                             {"debug", LogLevel::kDebug}};

constexpr std::pair<std::string_view, std::int64_t> kStoreUnits[] = {
    {"MB", 1'000'000}, {"GB", 1'000'000'000}, {"TB", 1'000'000'000'000}};
constexpr SizeRule kStoreSize{.min = 10'000'000,
                              .max = 1'000'000'000'000'000,
                              .range = "10MB to 1000TB",
                              .allowed = "10MB to 1000TB, with MB, GB or TB",
                              .pattern = "[0-9]+(MB|GB|TB)",
                              .units = kStoreUnits};
// The least rate sends two messages of 32 000 bytes in 1.3 s.
constexpr std::pair<std::string_view, std::int64_t> kRateUnits[] = {{"kB/s", 1'000},
                                                                    {"MB/s", 1'000'000}};
constexpr SizeRule kRate{.min = 50'000,
                         .max = 1'000'000'000,
                         .range = "50kB/s to 1000MB/s",
                         .allowed = "50kB/s to 1000MB/s, with kB/s or MB/s",
                         .pattern = R"([0-9]+(\\.[0-9]+)?(kB|MB)/s)",
                         .units = kRateUnits,
                         .fractions = true,
                         .outside = "is too small or too large"};

// A reference to another map.
std::string map_named(std::string_view name) {
  return R"({ "$ref": "#/$defs/)" + std::string(name) + R"(" })";
}

constexpr std::string_view kPath = R"({ "type": "string", "minLength": 1 })";

}  // namespace

const Rows<BridgeSpec>& bridge_rows() {
  static const Rows<BridgeSpec> rows(
      "bridge", "the configuration",
      {
          {{.name = "bridge",
            .fallback = "needed",
            .text = "the name that stations see, or a map with it, see below",
            .schema = R"({ "anyOf": [{ "$ref": "#/$defs/word" }, )" + map_named("identity") + "] }",
            .form = NameRule{}.form()}},
          {{.name = "dds", .text = "see below", .schema = map_named("dds")}},
          {{.name = "log", .text = "see below", .schema = map_named("log")}},
          {{.name = "store",
            .fallback = "nothing is kept",
            .text = "see below",
            .schema = map_named("store")}},
          {{.name = "program",
            .fallback = "none",
            .text = "programming software reaches PLCs through the bridge, see below",
            .schema = map_named("program")}},
          {{.name = "metrics",
            .fallback = "served nowhere",
            .text = "figures of buses and devices for Prometheus, see below",
            .schema = map_named("metrics")}},
          {{.name = "configure",
            .fallback = "refused",
            .text = "engineers change this file through the bridge, see below",
            .schema = map_named("configure")}},
          {{.name = "buses",
            .fallback = "needed",
            .text = fmt::format("1 to {} buses", kMaxBuses),
            .schema = R"({ "type": "array", "minItems": 1, "maxItems": )" +
                      std::to_string(kMaxBuses) + R"(, "items": { "$ref": "#/$defs/bus" } })"}},
      });
  return rows;
}

const Rows<BridgeSpec>& identity_rows() {
  static const Rows<BridgeSpec> rows(
      "identity", "'bridge'",
      {
          field({.name = "name",
                 .fallback = "needed",
                 .text = "the name that stations see",
                 .example = "a name for the bridge"},
                &BridgeSpec::name, NameRule{}),
          {{.name = "standby",
            .fallback = "it stands alone",
            .text = "bridges with the same channels that stand by for each other, see below",
            .schema = map_named("standby")}},
      },
      "The map that `bridge` may be instead of a name.");
  return rows;
}

const Rows<StandbySpec>& standby_rows() {
  static const Rows<StandbySpec> rows(
      "standby", "'standby'",
      {
          field({.name = "group",
                 .fallback = "needed",
                 .text = "the name of the group, the same for all its bridges",
                 .example = "a name for the group"},
                &StandbySpec::group, NameRule{}),
          field({"strength", "0",
                 "the strongest member that is ready takes over when the master has left"},
                &StandbySpec::strength, WholeRule{0, kMaxStrength}),
      },
      "One bridge of the group serves the buses, and the others take over when it has left: "
      "[docs/redundancy.md](../docs/redundancy.md).");
  return rows;
}

const Rows<DdsSpec>& dds_rows() {
  static const Rows<DdsSpec> rows(
      "dds", "'dds'",
      {
          field({"domain", "0"}, &DdsSpec::domain, WholeRule{0, kMaxDomain}),
          {{.name = "interfaces",
            .fallback = "[127.0.0.1]: this machine only",
            .text = "IPv4 addresses that DDS may use; 127.0.0.1 is always one of them",
            .schema = R"({ "type": "array", "minItems": 1, "maxItems": )" +
                      std::to_string(kMaxInterfaces) +
                      R"(, "items": { "type": "string", )"
                      R"("pattern": "^[0-9]{1,3}(\\.[0-9]{1,3}){3}$" } })"}},
          {{.name = "discovery-server",
            .fallback = "none",
            .text = "`host:port` of a Fast DDS discovery server, instead of multicast",
            .schema = HostPortRule{}.schema()}},
          {{.name = "discovery-servers",
            .fallback = "none",
            .text = "several, in the order of their identities 0, 1, ..; every program names all: "
                    "`[a:11811, b:11811]`",
            .schema = R"({ "type": "array", "minItems": 1, "maxItems": )" +
                      std::to_string(kMaxServers) +
                      R"(, "items": { "type": "string", "pattern": "^.+:[0-9]{1,5}$" } })"}},
          {{.name = "profile",
            .fallback = "none",
            .text = "a Fast DDS XML file, relative to this file; its participant profile "
                    "`fieldcast` is used",
            .schema = std::string(kPath)}},
          field({"partition", "none", "of all publishers and subscribers"}, &DdsSpec::partition,
                TextRule{kMaxPartition}),
          {{.name = "security",
            .fallback = "needed off the loopback",
            .text = "the folder of a member, relative to this file, as `fieldcast secure add` "
                    "makes it; `none` where everybody in the network may read and command",
            .schema = std::string(kPath)}},
          field({"max-rate", "no bound",
                 "how fast this program sends what it publishes, for all readers "
                 "together; discovery and acknowledgements come on top"},
                &DdsSpec::max_rate, kRate),
          field({"max-participants", "1024",
                 "participants of the domain that are accepted at a time; more "
                 "are refused and counted"},
                &DdsSpec::max_participants, WholeRule{2, 65'536}),
          field(
              {"max-endpoints", "8192", "readers and writers that are accepted of one participant"},
              &DdsSpec::max_endpoints, WholeRule{64, 65'536}),
          field({"max-sample", "1048576",
                 "bytes of the longest message that is accepted in fragments"},
                &DdsSpec::max_sample, WholeRule{65'536, 67'108'864}),
      });
  return rows;
}

const Rows<DdsSite>& site_rows() {
  static const Rows<DdsSite> rows(
      "site", "a site",
      {
          field({.name = "name",
                 .fallback = std::string(kNeeded),
                 .text = "stands before the names of its buses: `north:line-7`",
                 .example = "a name for the site"},
                &DdsSite::name, NameRule{}),
          {{.name = "dds", .text = "as of the bridge", .schema = "{}"}},
      },
      "One of several sites that a station watches.");
  return rows;
}

const Rows<LogSpec>& log_rows() {
  static const Rows<LogSpec> rows(
      "log", "'log'", {field({"level", "info"}, &LogSpec::level, ChoiceRule<LogLevel>{kLevels})});
  return rows;
}

const Rows<StoreSpec>& store_rows() {
  static const Rows<StoreSpec> rows(
      "store", "'store'",
      {
          {{.name = "path",
            .text = "a file of SQLite, relative to this file; it is made when it is missing, and "
                    "readable for its owner only",
            .schema = std::string(kPath)}},
          {{.name = "url",
            .text = "`postgresql://USER@HOST:PORT/DATABASE`; leave the password to `~/.pgpass` or "
                    "`passfile=`",
            .schema = R"({ "type": "string", "pattern": "^postgres(ql)?://" })"}},
          {{.name = "samples",
            .fallback = "[\"*\"]: all",
            .text =
                "patterns `BUS/DEVICE/CHANNEL` of the channels whose samples are kept; `[]`: of "
                "none",
            .schema = R"({ "type": "array", "maxItems": )" + std::to_string(kMaxPatterns) +
                      R"(, "items": { "type": "string", "minLength": 1 } })"}},
          field({"keep", "30d", "how long samples are kept"}, &StoreSpec::keep, KeepRule{}),
          field({"keep-minutes", "365d",
                 "how long least, largest and mean value of each minute are kept"},
                &StoreSpec::keep_minutes, KeepRule{}),
          field({"keep-hours", "3650d", "how long the same of each hour are kept"},
                &StoreSpec::keep_hours, KeepRule{}),
          field({.name = "max-size",
                 .fallback = "no bound",
                 .text =
                     "of the file, or of the samples on a server: `2GB`; beyond it the oldest go, "
                     "on a server whole days but the present one"},
                &StoreSpec::max_bytes, kStoreSize),
      },
      "Keeps samples, users, alarms, device states and the audit.", {"path", "url"});
  return rows;
}

const Rows<MetricsSpec>& metrics_rows() {
  static const Rows<MetricsSpec> rows(
      "metrics", "'metrics'",
      {field({.name = "listen",
              .fallback = "needed",
              .text = "`ADDRESS:PORT` of this machine. There is no login and no TLS: every client "
                      "that reaches "
                      "the address reads the figures, so choose one of the loopback where you can",
              .example = "listen: 127.0.0.1:9464"},
             &MetricsSpec::listen, ListenRule{9464})},
      "Serves `http://ADDRESS:PORT/metrics` as OpenMetrics text.");
  return rows;
}

const Rows<ConfigureSpec>& configure_rows() {
  static const Rows<ConfigureSpec> rows(
      "configure", "'configure'",
      {field({"allow", "false",
              "`true`: engineers read this file and change it, except the lines that protect the "
              "bridge. The bridge then needs DDS Security, or DDS on this machine only"},
             &ConfigureSpec::allow, FlagRule{})},
      "Lets engineers change this file in the browser: "
      "[docs/station.md](../docs/station.md#change-the-configuration).");
  return rows;
}

}  // namespace fieldcast::config
