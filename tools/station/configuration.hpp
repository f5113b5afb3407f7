// The configuration of fieldcast-station: a YAML file, or the defaults. Functions without state.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <vector>

#include "config/fault.hpp"
#include "config/loader.hpp"
#include "core/access/role.hpp"
#include "core/model/spec.hpp"

namespace fieldcast::web {

// What those may do who are not logged in, when the configuration says it.
enum class LocalRole : std::uint8_t { kNone, kViewer, kOperator };

struct WebSpec {
  ListenSpec listen{"127.0.0.1", 8090};
  std::string certificate, key;    // paths; set: TLS
  std::vector<std::string> hosts;  // further names of this station
  std::vector<std::string> embed;  // sites that may show /embed in a frame
  std::optional<LocalRole> local_role;
};

struct StationSpec {
  std::string name = "station";
  std::vector<DdsSite> sites{DdsSite{}};  // one without a name, or several
  LogSpec log;
  WebSpec web;
  // `samples` are the patterns of what is recorded; none: nothing is.
  std::optional<StoreSpec> store;
};

using LoadedStation = tl::expected<StationSpec, std::vector<config::Fault>>;

// `listen` goes before that of the file. All faults at once, in the order of the text. `places`
// receives the positions of the keys; may be null.
[[nodiscard]] LoadedStation load_station(const std::string& path,
                                         const std::optional<ListenSpec>& listen = {},
                                         config::Places* places = nullptr);
[[nodiscard]] LoadedStation load_station_text(std::string_view text, const std::string& file_name,
                                              const config::FileReader& reader,
                                              const std::optional<ListenSpec>& listen = {},
                                              config::Places* places = nullptr);

// Why a station must not be reached as this one would be, and how to mend it: off the loopback it
// needs TLS and a login, and never a role for everybody.
struct Exposure {
  std::string_view key;  // of `web`: where the fault is
  std::string what, mend;
};
[[nodiscard]] std::vector<Exposure> exposures_of(const StationSpec& spec);

// "127.0.0.1:8090", "[::1]:8090", "127.0.0.1:0" (a free port); nothing: no address of this machine
// and port.
[[nodiscard]] std::optional<ListenSpec> listen_from(const std::string& text);

// Every key with what it is for, for the document: "web.listen".
struct DocumentedKey {
  std::string name, fallback, form, text;
};
[[nodiscard]] std::vector<DocumentedKey> documented_keys();

}  // namespace fieldcast::web
