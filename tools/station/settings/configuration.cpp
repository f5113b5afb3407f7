#include "tools/station/settings/configuration.hpp"

#include <fmt/format.h>

#include "config/document/limits.hpp"
#include "config/document/map_reader.hpp"
#include "config/document/scalars.hpp"
#include "config/files/file_reader.hpp"
#include "config/files/library.hpp"
#include "config/sections/bridge_keys.hpp"
#include "config/sections/dds.hpp"
#include "config/sections/port.hpp"
#include "config/sections/program.hpp"
#include "config/sections/store.hpp"
#include "core/model/channel_pattern.hpp"
#include "tools/forward/settings/connection_keys.hpp"
#include "tools/station/settings/notify_keys.hpp"
#include "tools/station/settings/notify_rows.hpp"
#include "tools/station/settings/origin_check.hpp"
#include "tools/station/settings/report_keys.hpp"
#include "tools/station/settings/text_list.hpp"

namespace fieldcast::web {
namespace {

using config::FaultList;
using config::field;
using config::Kind;
using config::MapReader;
using config::Node;
using config::Rows;

constexpr int kUsualPort = 8090;

constexpr std::pair<std::string_view, LocalRole> kLocalRoles[] = {
    {"none", LocalRole::kNone},
    {"viewer", LocalRole::kViewer},
    {"operator", LocalRole::kOperator},
    {"engineer", LocalRole::kEngineer}};

struct RecordSpec {
  std::vector<std::string> patterns{"*"};
  Duration backfill = StationSpec{}.backfill;
};

std::string fault_of_host(const std::string& text) {
  return is_host_name(text) ? "" : fmt::format("hosts: '{}' is no name of a host", text);
}

// "https://wiki.plant:8443"
std::string fault_of_site(const std::string& text) {
  for (const std::string_view scheme : {"https://", "http://"}) {
    if (text.starts_with(scheme) && is_host_name(std::string_view(text).substr(scheme.size())))
      return {};
  }
  return fmt::format("embed: '{}' is no address of a site", text);
}

std::string fault_of_pattern(const std::string& text) {
  const auto pattern = Pattern::parse(text);
  return pattern ? "" : "patterns: " + pattern.error();
}

constexpr Duration kMostBackfill = std::chrono::hours{24 * 366};

const Rows<WebSpec>& web_rows() {
  static const Rows<WebSpec> rows(
      "web", "'web'",
      {
          field<WebSpec>({.name = "listen",
                          .fallback = "127.0.0.1:8090",
                          .text = "`ADDRESS:PORT` of this machine; off the loopback `certificate`, "
                                  "`key` and a `store` with users are needed"},
                         &WebSpec::listen, config::ListenRule{kUsualPort}),
          {{.name = "certificate",
            .fallback = "no TLS",
            .text = "a PEM file with the certificate and its chain, relative to this file",
            .schema = R"({ "type": "string" })"}},
          {{.name = "key",
            .fallback = "no TLS",
            .text = "a PEM file with the private key of the certificate",
            .schema = R"({ "type": "string" })"}},
          {{.name = "hosts",
            .fallback = "[]",
            .text = "further names by which browsers reach the station, such as `station.plant`; "
                    "its address and localhost need none",
            .schema = std::string(kTextList)}},
          {{.name = "embed",
            .fallback = "[]: nobody",
            .text = "sites that may show `/embed` in a frame, such as `https://wiki.plant`",
            .schema = std::string(kTextList)}},
          field<WebSpec>(
              {.name = "local-role",
               .fallback = "`viewer` while there are no users, then `none`",
               .text =
                   "what everybody on this machine may do without a login; on the loopback only"},
              &WebSpec::local_role, config::ChoiceRule<LocalRole>{kLocalRoles}),
      },
      "Where the page is served.");
  return rows;
}

const Rows<RecordSpec>& record_rows() {
  static const Rows<RecordSpec> rows(
      "record", "'record'",
      {{{.name = "patterns",
         .fallback = "[\"*\"]: all",
         .text = "patterns `BUS/DEVICE/CHANNEL` of the channels whose samples are recorded",
         .schema = std::string(kTextList)}},
       field<RecordSpec>(
           {.name = "backfill",
            .fallback = "1d",
            .text = "samples that the station missed are fetched from the store of the bridge if "
                    "they are not older; `0s`: they are not fetched"},
           &RecordSpec::backfill, config::DurationRule{Duration{}, kMostBackfill})},
      "Records what all bridges of the domain publish, in `store`.");
  return rows;
}

const Rows<forward::JetStreamSpec>& stream_rows() {
  static const Rows<forward::JetStreamSpec> rows = [] {
    auto fields = forward::connection_fields();
    for (auto& each : forward::stream_name_fields(" at the forwarders"))
      fields.push_back(std::move(each));
    fields.push_back({{.name = "commands",
                       .fallback = "`false`",
                       .text = "sends commands of users to the sites whose forwarders allow it",
                       .schema = R"({"type": "boolean"})"}});
    return Rows<forward::JetStreamSpec>(
        "stream", "'stream'", std::move(fields),
        "Reads every site whose `fieldcast-forward` sends to this NATS JetStream.");
  }();
  return rows;
}

const Rows<StationSpec>& station_rows() {
  static const Rows<StationSpec> rows(
      "station", "the configuration",
      {
          field<StationSpec>({.name = "station",
                              .fallback = "`station`",
                              .text = "the name that other DDS participants see"},
                             &StationSpec::name, config::NameRule{}),
          {{.name = "dds", .text = "as of the bridge: `domain`, `interfaces`, ..", .schema = "{}"}},
          {{.name = "sites",
            .fallback = "the one of `dds`",
            .text = "several sites, instead of `dds`: a list of `{ name: N, dds: { .. } }`; "
                    "the name stands before those of its buses, `north:line-7`",
            .schema = "{}"}},
          {{.name = "stream",
            .fallback = "none is read",
            .text =
                "sites whose `fieldcast-forward` sends to NATS JetStream: `servers`, ..; without "
                "`dds` and `sites`, no DDS domain is joined",
            .schema = "{}"}},
          {{.name = "notify",
            .fallback = "nobody is notified",
            .text = "mails, webhooks and a heartbeat, see notifications.md; needs `store`",
            .schema = "{}"}},
          {{.name = "reports",
            .fallback = "[]",
            .text = "reports that are made by schedule: a list of maps, each with a `name`; needs "
                    "`store`",
            .schema = "{}"}},
          {{.name = "log", .text = "as of the bridge: `level`", .schema = "{}"}},
          {{.name = "web", .text = "where the page is served", .schema = "{}"}},
          {{.name = "store",
            .fallback = "nothing is kept, and there are no users",
            .text = "as of the bridge: `path` or `url`, `keep`, ..",
            .schema = "{}"}},
          {{.name = "record",
            .fallback = "nothing is recorded",
            .text = "what is recorded of all bridges, in `store`",
            .schema = "{}"}},
      });
  return rows;
}

void read_web(MapReader& file, StationSpec& spec, config::Library& library,
              const std::optional<ListenSpec>& listen) {
  const Node* node = file.find("web");
  const auto check = [&](const std::function<config::Position(std::string_view)>& position) {
    if (listen) spec.web.listen = *listen;
    for (const Exposure& each : exposures_of(spec))
      file.faults().add(position(each.key), each.what, each.mend);
  };
  if (node == nullptr) return check([&](std::string_view) { return file.position(); });
  MapReader map(*node, web_rows(), file.faults());
  web_rows().read(map, spec.web);
  for (const auto& [key, target] :
       {std::pair{"certificate", &spec.web.certificate}, std::pair{"key", &spec.web.key}}) {
    std::string path;
    if (map.read(key, path, config::TextRule{config::kMaxPath}))
      *target = library.check_file(*map.find(key));
  }
  read_texts(map, "hosts", "a name such as station.plant", spec.web.hosts, fault_of_host);
  read_texts(map, "embed", "an address such as https://wiki.plant", spec.web.embed, fault_of_site);
  check([&](std::string_view key) { return map.position_of(key); });
}

void read_stream(MapReader& file, StationSpec& spec, config::Library& library) {
  const Node* node = file.find("stream");
  if (node == nullptr) return;
  MapReader map(*node, stream_rows(), file.faults());
  spec.stream.emplace();
  stream_rows().read(map, *spec.stream);
  map.read("commands", spec.stream_commands, config::FlagRule{});
  forward::read_connection(map, *spec.stream, library);
}

void read_record(MapReader& file, StationSpec& spec) {
  const Node* node = file.find("record");
  if (spec.store && node == nullptr) spec.store->samples.clear();
  if (node == nullptr) return;
  RecordSpec record;
  MapReader map(*node, record_rows(), file.faults());
  record_rows().read(map, record);
  spec.backfill = record.backfill;
  read_texts(map, "patterns", "BUS/DEVICE/CHANNEL with *", record.patterns, fault_of_pattern);
  if (spec.store) {
    spec.store->samples = std::move(record.patterns);
  } else if (!file.has("store")) {
    file.faults().add(file.position_of("record"), "nothing can be recorded without a store",
                      "store: { path: FILE }");
  }
}

std::vector<config::Fault> whole_file(const std::string& file, std::string what) {
  return {config::Fault{file, 1, 1, std::move(what), {}, {}}};
}

}  // namespace

std::vector<Exposure> exposures_of(const StationSpec& spec) {
  std::vector<Exposure> found;
  const WebSpec& web = spec.web;
  if (web.certificate.empty() != web.key.empty()) {
    const bool certificate = web.key.empty();
    found.push_back({certificate ? "certificate" : "key",
                     certificate ? "'certificate' without 'key'" : "'key' without 'certificate'",
                     "both, as PEM files"});
  }
  if (on_loopback(web.listen)) return found;
  if (web.certificate.empty() && web.key.empty())
    found.push_back({"listen", "the page off the loopback without TLS",
                     "certificate and key in 'web', or an address 127.0.0.1"});
  if (!spec.store)
    found.push_back({"listen",
                     "off the loopback everybody has to log in, and without a store there are no "
                     "users",
                     "store: { path: FILE } and 'fieldcast user add NAME --role operator', or an "
                     "address 127.0.0.1"});
  if (web.local_role && *web.local_role != LocalRole::kNone)
    found.push_back({"local-role", "a role for everybody off the loopback",
                     "local-role: none, or an address 127.0.0.1"});
  if ((web.listen.host == "0.0.0.0" || web.listen.host == "::") && web.hosts.empty())
    found.push_back({"listen", "every address of this machine, and no name to reach it by",
                     "hosts: [NAME] in 'web', or one address"});
  return found;
}

LoadedStation load_station_text(std::string_view text, const std::string& file_name,
                                const config::FileReader& reader,
                                const std::optional<ListenSpec>& listen, config::Places* places) {
  if (!config::is_empty(text) &&
      !config::has_top_key(text, {"station", "dds", "log", "web", "store", "record", "sites",
                                  "stream", "notify", "reports"}))
    return tl::make_unexpected(whole_file(file_name, "this is no configuration of a station"));
  FaultList faults;
  const std::shared_ptr<const config::Document> document =
      config::parse_yaml(config::Source{file_name, std::string(text), 0}, faults);
  StationSpec spec;
  if (document->root != nullptr) {
    const config::LoadOptions options = config::default_options();
    config::Library library(reader, options, faults, text.size());
    MapReader file(*document->root, station_rows(), faults);
    station_rows().read(file, spec);
    const bool has_dds = file.find("dds") != nullptr;
    const bool joins = file.find("sites") != nullptr || has_dds || !file.has("stream");
    spec.sites = joins ? read_sites(file, library) : std::vector<DdsSite>{};
    read_stream(file, spec, library);
    read_log(file, spec.log);
    read_store(file, spec.store);
    read_record(file, spec);
    read_notify(file, library, spec.notify);
    read_reports(file, spec.notify ? spec.notify->targets : std::vector<NotifyTarget>{},
                 spec.reports);
    read_web(file, spec, library, listen);
  } else if (faults.empty()) {
    return tl::make_unexpected(whole_file(file_name, "the file is empty"));
  }
  if (!faults.empty()) return tl::make_unexpected(faults.take());
  if (places != nullptr) *places = config::Places(document);
  return spec;
}

LoadedStation load_station(const std::string& path, const std::optional<ListenSpec>& listen,
                           config::Places* places) {
  const config::FileReader reader = config::disk_reader();
  const auto text = reader.read(path);
  if (!text)
    return tl::make_unexpected(
        whole_file(path, fmt::format("the file {}", config::to_text(text.error()))));
  return load_station_text(*text, path, reader, listen, places);
}

std::optional<ListenSpec> listen_from(const std::string& text) {
  const bool any_port = text.ends_with(":0");  // port 0 selects a free port
  const auto endpoint =
      config::host_port_from(any_port ? text.substr(0, text.size() - 1) + '1' : text);
  if (!endpoint) return std::nullopt;
  if (!config::is_ipv4(endpoint->first) && endpoint->first.find(':') == std::string::npos)
    return std::nullopt;
  return ListenSpec{endpoint->first, any_port ? std::uint16_t{0} : endpoint->second};
}

std::vector<DocumentedKey> documented_keys() {
  std::vector<DocumentedKey> all;
  const auto add = [&all](const std::string& prefix, const config::RowTable& table) {
    for (const config::Key& row : table.rows)
      all.push_back({prefix + std::string(row.name), row.fallback, row.form, row.text});
  };
  add("", station_rows());
  add("web.", web_rows());
  add("record.", record_rows());
  add("stream.", stream_rows());
  for (const auto& [prefix, table] : notify_tables()) add(prefix, *table);
  add("reports.", report_rows());
  return all;
}

}  // namespace fieldcast::web
