// Fuzzes a client of /live with any texts, one per line. Each response must be a JSON object, each
// ineffective message is refused with a reason, a viewer sends no command, and no interest remains
// after a disconnect.
//
// Input: the user(1), then the lines.
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "core/base/bytes.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/tools/station/live/live_client_support.hpp"

namespace fieldcast::web {
namespace {

void check_texts(LivePerson& person) {
  for (const std::string& text : person.texts()) {
    const auto json = nlohmann::json::parse(text, nullptr, false);
    if (!json.is_object() || !json.contains("kind")) std::abort();
    if (json["kind"] == "refused" && json["error"].get<std::string>().empty()) std::abort();
  }
}

void run_one(ByteView data) {
  if (data.empty()) return;
  const bool viewer = data[0] % 2 == 0;
  std::string_view rest(reinterpret_cast<const char*>(data.data()) + 1, data.size() - 1);
  FakeDomain domain;
  for (const auto& [name, type] : {std::pair{"oil", "float32"}, {"name", "string(8)"}}) {
    domain.announce(name, type);
    domain.publish(name, 1.5);
  }
  {
    LivePerson person{domain, "anna", viewer ? Role::kViewer : Role::kOperator};
    while (!rest.empty()) {
      const auto line = rest.substr(0, rest.find('\n'));
      rest.remove_prefix(std::min(rest.size(), line.size() + 1));
      person.say(line);
      domain.publish("oil", 2.5);
      person.wait(std::chrono::milliseconds{20 + line.size() % 64});
      if (person.peer.under_way && line.size() % 3 != 0) person.take();
      check_texts(person);
      for (auto& asked : domain.commands.asked) {
        if (asked.command.bus.empty()) std::abort();
        asked.done({.user = "anna", .state = "done", .values = asked.command.command.values});
      }
      if (viewer && !domain.commands.asked.empty()) std::abort();
      domain.commands.asked.clear();
      check_texts(person);
    }
  }
  if (domain.interests.count() != 0 || domain.hub.count() != 0) std::abort();
}

}  // namespace
}  // namespace fieldcast::web

FIELDCAST_FUZZ_TARGET(fieldcast::web::run_one)
