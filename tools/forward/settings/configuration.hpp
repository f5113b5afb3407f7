// Loads the configuration of fieldcast-forward. Stateless functions.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <variant>
#include <vector>

#include "config/document/fault.hpp"
#include "config/files/file_reader.hpp"
#include "core/model/spec.hpp"
#include "tools/forward/batch/gatherer.hpp"
#include "tools/forward/command/command_service.hpp"
#include "tools/forward/outlet/nats/jetstream_spec.hpp"
#include "tools/forward/outlet/postgresql/postgresql_spec.hpp"
#include "tools/forward/payload/record_payload.hpp"
#include "tools/forward/queue/queue.hpp"
#include "tools/forward/send/sender.hpp"

namespace fieldcast::forward {

// The engine, by the section of the configuration.
using OutletSpec = std::variant<JetStreamSpec, PostgresqlSpec>;

struct ForwardSpec {
  std::string site;
  DdsSpec dds;
  LogSpec log;
  QueueSpec queue;
  GatherSpec gather;
  PayloadSpec payload;
  SendSpec send;
  OutletSpec outlet;
  std::optional<CommandSpec> commands;  // empty: none are accepted
  std::optional<MetricsSpec> metrics;   // empty: metrics are not served
};

using LoadedForward = tl::expected<ForwardSpec, std::vector<config::Fault>>;

// Returns all faults in the order of the text.
[[nodiscard]] LoadedForward load_forward(const std::string& path, config::Places* places = nullptr);
[[nodiscard]] LoadedForward load_forward_text(std::string_view text, const std::string& file_name,
                                              const config::FileReader& reader,
                                              config::Places* places = nullptr);

struct DocumentedKey {
  std::string name, fallback, form, text;
};
[[nodiscard]] std::vector<DocumentedKey> documented_keys();

}  // namespace fieldcast::forward
