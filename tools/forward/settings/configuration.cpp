#include "tools/forward/settings/configuration.hpp"

#include <fmt/format.h>

#include "config/document/limits.hpp"
#include "config/document/map_reader.hpp"
#include "config/document/scalars.hpp"
#include "config/files/library.hpp"
#include "config/sections/dds.hpp"
#include "tools/forward/settings/forward_keys.hpp"
#include "tools/forward/settings/server_address.hpp"

namespace fieldcast::forward {
namespace {

using config::FaultList;
using config::Kind;
using config::MapReader;
using config::Node;

constexpr std::string_view kServerForm = "nats://HOST:PORT or tls://HOST:PORT";

void read_servers(MapReader& map, JetStreamSpec& spec) {
  const Node* node = map.find("servers");
  if (node == nullptr) return;
  if (!config::is_list(*node, "servers", 1, kMostServers,
                       fmt::format("a list of 1 to {}, each {}", kMostServers, kServerForm),
                       map.faults(), config::as_list(*node)))
    return;
  spec.servers.clear();
  for (const Node* item : node->items) {
    const std::string* text = config::scalar_of(*item, "server", kServerForm, map.faults());
    if (text == nullptr) continue;
    const auto address = server_address_from(*text);
    if (!address) {
      map.faults().add(item->position, address.error(), kServerForm);
      continue;
    }
    if (!address->tls && !address->on_loopback && !spec.without_tls) {
      map.faults().add(item->position,
                       fmt::format("server '{}' is off this machine and without TLS", *text),
                       "tls://HOST:PORT, or without-tls: true if the network is trusted",
                       "tls" + text->substr(text->find("://")));
    }
    spec.servers.push_back(*text);
  }
}

// The file must exist; the access to its content is checked when it is used.
void read_files(MapReader& map, JetStreamSpec& spec, config::Library& library) {
  for (const auto& [key, target] :
       {std::pair{"authority", &spec.authority}, std::pair{"certificate", &spec.certificate},
        std::pair{"key", &spec.key}, std::pair{"password-file", &spec.password_file},
        std::pair{"token-file", &spec.token_file}, std::pair{"credentials", &spec.credentials}}) {
    std::string path;
    if (map.read(key, path, config::TextRule{config::kMaxPath}))
      *target = library.check_file(*map.find(key));
  }
}

void check_login(MapReader& map, const JetStreamSpec& spec) {
  if (spec.certificate.empty() != spec.key.empty())
    map.fault(spec.key.empty() ? "certificate" : "key",
              spec.key.empty() ? "'certificate' without 'key'" : "'key' without 'certificate'",
              "both, as PEM files");
  if (spec.user.empty() != spec.password_file.empty())
    map.fault(
        spec.user.empty() ? "password-file" : "user",
        spec.user.empty() ? "'password-file' without 'user'" : "'user' without 'password-file'",
        "both");
  const int logins = (spec.password_file.empty() ? 0 : 1) + (spec.token_file.empty() ? 0 : 1) +
                     (spec.credentials.empty() ? 0 : 1);
  if (logins > 1)
    map.fault("servers", "more than one login",
              "one of: user with password-file, token-file, credentials");
  const bool has_files = !spec.authority.empty() || !spec.certificate.empty();
  if (has_files && !uses_tls(spec))
    map.fault("servers", "'authority' or 'certificate' without a server tls://HOST:PORT",
              "servers: [tls://HOST:PORT]");
}

void check_names(MapReader& map, const JetStreamSpec& spec) {
  for (const auto& [key, name] :
       {std::pair{"sample-stream", spec.sample_stream},
        std::pair{"alarm-stream", spec.alarm_stream}, std::pair{"bucket", spec.bucket}}) {
    if (name.find('.') != name.npos)
      map.fault(key, fmt::format("{} '{}' contains '.', which NATS does not allow", key, name),
                "letters, digits, '-' and '_'");
  }
}

void read_jetstream(MapReader& file, ForwardSpec& spec, config::Library& library) {
  const Node* node = file.find("jetstream");
  if (node == nullptr) return;
  MapReader map(*node, jetstream_rows(), file.faults());
  JetStreamKeys keys{spec.jetstream, spec.send};
  jetstream_rows().read(map, keys);
  spec.jetstream = std::move(keys.outlet);
  spec.send = keys.send;
  read_servers(map, spec.jetstream);
  read_files(map, spec.jetstream, library);
  check_login(map, spec.jetstream);
  check_names(map, spec.jetstream);
  if (const Node* streams = map.find("streams"); streams != nullptr) {
    MapReader inner(*streams, stream_rows(), file.faults());
    stream_rows().read(inner, spec.jetstream.streams);
  }
}

template <class Owner>
void read_section(MapReader& file, std::string_view key, const config::Rows<Owner>& rows,
                  Owner& owner) {
  const Node* node = file.find(key);
  if (node == nullptr) return;
  MapReader map(*node, rows, file.faults());
  rows.read(map, owner);
}

void read_queue(MapReader& file, ForwardSpec& spec) {
  const Node* node = file.require("queue", "queue: { path: FILE }");
  if (node == nullptr) return;
  MapReader map(*node, queue_rows(), file.faults());
  queue_rows().read(map, spec.queue);
  if (!spec.queue.path.empty())
    spec.queue.path = config::resolve(*map.position().source, spec.queue.path);
}

std::vector<config::Fault> whole_file(const std::string& file, std::string what) {
  return {config::Fault{file, 1, 1, std::move(what), {}, {}}};
}

}  // namespace

LoadedForward load_forward_text(std::string_view text, const std::string& file_name,
                                const config::FileReader& reader, config::Places* places) {
  if (!config::is_empty(text) && !config::has_top_key(text, {"site", "queue", "jetstream"}))
    return tl::make_unexpected(
        whole_file(file_name, "this is not a configuration of fieldcast-forward"));
  FaultList faults;
  const std::shared_ptr<const config::Document> document =
      config::parse_yaml(config::Source{file_name, std::string(text), 0}, faults);
  ForwardSpec spec;
  if (document->root != nullptr) {
    const config::LoadOptions options = config::default_options();
    config::Library library(reader, options, faults, text.size());
    MapReader file(*document->root, forward_rows(), faults);
    forward_rows().read(file, spec);
    config::read_dds(file, spec.dds, library);
    config::read_log(file, spec.log);
    read_queue(file, spec);
    read_section(file, "gather", gather_rows(), spec.gather);
    read_section(file, "payload", payload_rows(), spec.payload);
    read_jetstream(file, spec, library);
  } else if (faults.empty()) {
    return tl::make_unexpected(whole_file(file_name, "the file is empty"));
  }
  if (!faults.empty()) return tl::make_unexpected(faults.take());
  if (places != nullptr) *places = config::Places(document);
  return spec;
}

LoadedForward load_forward(const std::string& path, config::Places* places) {
  const config::FileReader reader = config::disk_reader();
  const auto text = reader.read(path);
  if (!text)
    return tl::make_unexpected(
        whole_file(path, fmt::format("the file {}", config::to_text(text.error()))));
  return load_forward_text(*text, path, reader, places);
}

}  // namespace fieldcast::forward
