#include "tools/cli/view/sessions_view.hpp"

#include "tools/cli/model/sample_text.hpp"

namespace fieldcast::cli {

std::vector<std::string> sessions_lines(const SessionsModel& model, UtcTime now,
                                        const Screen& screen) {
  if (model.empty()) return {"no device has been programmed"};
  TextTable table({{"device"},
                   {"state"},
                   {"who"},
                   {"bytes to it", Align::kRight},
                   {"from it", Align::kRight},
                   {"begun", Align::kRight}});
  for (const auto& [key, session] : model) {
    table.add_row({{session.bus + '/' + session.device},
                   {std::string(to_text(session.state)),
                    session.state == ProgramSessionState::kOpen ? Tone::kGood : Tone::kFaint},
                   {session.who},
                   {std::to_string(session.bytes_to_device)},
                   {std::to_string(session.bytes_from_device)},
                   {age_text(session.since, now), Tone::kFaint}});
  }
  return table.render(screen);
}

Json session_json(const ProgramSessionReport& session) {
  return {{"bus", session.bus},
          {"device", session.device},
          {"state", to_text(session.state)},
          {"who", session.who},
          {"bytes_to_device", session.bytes_to_device},
          {"bytes_from_device", session.bytes_from_device},
          {"since", session.since.nanoseconds}};
}

}  // namespace fieldcast::cli
