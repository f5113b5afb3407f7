#include "tools/forward/settings/configuration.hpp"

#include <fmt/format.h>

#include "config/document/limits.hpp"
#include "config/document/map_reader.hpp"
#include "config/files/library.hpp"
#include "config/sections/bridge_keys.hpp"
#include "config/sections/dds.hpp"
#include "tools/forward/settings/command_keys.hpp"
#include "tools/forward/settings/forward_keys.hpp"
#include "tools/forward/settings/outlet_sections.hpp"

namespace fieldcast::forward {
namespace {

using config::FaultList;
using config::Kind;
using config::MapReader;
using config::Node;

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
  if (!config::is_empty(text) && !config::has_top_key(text, {"site", "queue"}))
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
    gather_rows().read_section(file, "gather", spec.gather);
    payload_rows().read_section(file, "payload", spec.payload);
    send_rows().read_section(file, "send", spec.send);
    spec.outlet = read_outlet(file, library);
    spec.commands = read_commands(file, spec.outlet);
    if (auto* const sparkplug = std::get_if<SparkplugSpec>(&spec.outlet))
      sparkplug->command_user = spec.commands ? spec.commands->user : "";
    if (file.find("metrics") != nullptr)
      config::metrics_rows().read_section(file, "metrics", spec.metrics.emplace());
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
