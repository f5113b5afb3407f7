#include "tools/station/live/command_sink.hpp"

#include "core/base/json.hpp"

namespace fieldcast::web {

std::string outcome_json(const CommandOutcome& outcome) {
  JsonObject json;
  json.add("request_id", outcome.request_id)
      .add("target", outcome.target)
      .add("state", outcome.state)
      .add("cause", outcome.cause)
      .add("reason", outcome.reason);
  if (outcome.values.empty()) {
    json.add_json("value", "null");
  } else {
    json.add_value("value", outcome.values.front());
  }
  if (outcome.values.size() > 1)
    json.add_json("values", json_array(outcome.values, [](std::string& out, const Value& value) {
                    append_json_value(out, value);
                  }));
  return json.add("completed_ms", outcome.completed_at).take();
}

StationCommand write_command(const ChannelPath& path, Value value, bool verify) {
  StationCommand command = acquire_command(path);
  command.command.operation = Operation::kWrite;
  command.command.values = {std::move(value)};
  command.command.verify = verify;
  return command;
}

StationCommand acquire_command(const ChannelPath& path) {
  StationCommand command;
  command.bus = path.bus;
  command.command.device = path.device;
  command.command.target = ChannelTarget{path.channel};
  command.command.operation = Operation::kAcquire;
  return command;
}

}  // namespace fieldcast::web
