// Fuzzes the resources below /api with any target and body. Each request must get one response,
// valid JSON if declared so, and only a POST with values and a bus may send a command.
//
// Input: method(1), the target up to a line end, then the body.
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "core/base/bytes.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/tools/station/live/live_support.hpp"
#include "tools/station/api/api_routes.hpp"
#include "tools/station/api/base/exchange.hpp"
#include "tools/station/web/route_table.hpp"

namespace fieldcast::web {
namespace {

using fuzz::require;

class CountingCommands final : public CommandSink {
 public:
  Submitted submit(const Caller&, StationCommand command, Done) override {
    require(!command.bus.empty());
    return ++count;
  }
  Submitted submit(const Caller&, AlarmAction action, Done) override {
    require(!action.alarm.bus.empty());
    return ++count;
  }
  std::optional<CommandOutcome> find(std::string_view, std::uint64_t id) const override {
    return id == 1 ? std::optional(CommandOutcome{.request_id = 1, .state = "done"}) : std::nullopt;
  }
  std::uint64_t count = 0;
};

struct Resources {
  Resources() {
    for (const char* name : {"oil", "speed"}) {
      model.on_channel(channel_of(name));
      model.on_sample(sample_of(name, 1.5));
    }
    model.put(device_of("press", 1));
    model.put(bus_of("shop"));
    model.put(plan_of("shop"));
    add_routes(table, {.model = &model,
                       .commands = &commands,
                       .now = [] { return UtcTime{1'000'000'000'000}; },
                       .metrics = [] { return std::vector<Metric>{}; }});
  }
  LiveModel model;
  CountingCommands commands;
  RouteTable table;
};

void check(const HttpResponse& response) {
  require(response.status >= 200 && response.status < 600);
  if (response.content_type == "application/json" && !response.body.empty())
    require(nlohmann::json::accept(response.body));
}

void read_parameters(const HttpRequest& request) {
  const Parameters parameters(request, {"from", "to", "channel", "points", "bus", "every"});
  const UtcTime now{1'000'000'000'000};
  if (const auto fault = parameters.fault("channel")) check(*fault);
  const auto held = [](const auto& read) {
    if (!read) check(read.error());
  };
  held(parameters.span(now, kOneDay));
  held(parameters.channels("channel", 8));
  held(parameters.number("points", 1, 5000, 100));
  held(parameters.pattern("bus"));
  held(parameters.duration("every", std::chrono::seconds{1}));
}

void run_api(ByteView data) {
  if (data.empty()) return;
  static Resources api;
  const std::string_view text(reinterpret_cast<const char*>(data.data()) + 1, data.size() - 1);
  const auto end = std::min(text.find('\n'), text.size());
  const auto target = parse_target(text.substr(0, end));
  if (!target) return;
  HttpRequest request{.method = static_cast<Method>(data[0] % 3),
                      .path = target->path,
                      .query = target->query,
                      .body = std::string(text.substr(std::min(end + 1, text.size()))),
                      .accepts_gzip = data[0] >= 128};
  read_parameters(request);
  const auto route = api.table.find(request.method, request.path, Role::kEngineer);
  if (!route) return check(route.error());
  const std::uint64_t before = api.commands.count;
  int answers = 0;
  (*route)->handler(request, {"anna", Role::kEngineer, "127.0.0.1"}, [&](const HttpResponse& made) {
    ++answers;
    check(made);
    if (made.status >= 400) require(api.commands.count == before);
  });
  require(answers == 1);
  require(request.method == Method::kPost || api.commands.count == before);
}

}  // namespace
}  // namespace fieldcast::web

FIELDCAST_FUZZ_TARGET(fieldcast::web::run_api)
