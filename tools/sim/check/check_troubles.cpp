// Checks device errors, a silent device, and responses of a wrong station.
#include <fmt/format.h>

#include <algorithm>

#include "tools/sim/check/requests.hpp"
#include "tools/sim/check/sim_check.hpp"

namespace fieldcast::sim {
namespace {

constexpr std::uint8_t kCode = 4;

std::string frames(const std::vector<Bytes>& all) {
  std::string text;
  for (const Bytes& each : all) text += (text.empty() ? "" : " | ") + to_hex(each);
  return text;
}

void refusals(const Subject& subject, const Requests& requests, CheckRows& rows) {
  CheckRow row{.check = "device errors", .where = "refusals"};
  const bool silent =
      subject.device.declaration && subject.device.declaration.value->refusal.fields.empty();
  if (silent) row.note = "no error frame is declared: the device stays silent";
  std::uint16_t sequence = 0;
  for (const NamedRequest& example : requests.examples()) {
    BusFaults faults;
    for (const Area& area : requests.protocol().areas()) {
      faults.devices[subject.device.name].refused.push_back(
          {std::string(area.name), 0, area.items - 1, kCode});
    }
    LiveDevice live(subject, faults);
    const RunOutcome outcome = live.run(requests.protocol().begin(example.request, {++sequence}));
    // Each range has its own error code, or all ranges have one.
    const bool each =
        outcome.done && std::ranges::all_of(outcome.reply, [](const RangeReply& range) {
          return range.cause == Cause::kDeviceError;
        });
    const bool refused =
        each || outcome.cause == Cause::kDeviceError || outcome.cause == Cause::kDeviceBusy;
    (silent ? outcome.cause == Cause::kNoAnswer : refused)
        ? row.pass()
        : row.fail(fmt::format("{}: {}", example.name, outcome.text()), frames(outcome.answers));
  }
  rows.push_back(std::move(row));
}

void silence(const Subject& subject, const Requests& requests, CheckRows& rows) {
  CheckRow row{.check = "silence", .where = "a dead device"};
  BusFaults faults;
  faults.devices[subject.device.name].silence.push_back({});
  LiveDevice live(subject, faults);
  std::uint16_t sequence = 0;
  for (const NamedRequest& example : requests.examples()) {
    const RunOutcome outcome = live.run(requests.protocol().begin(example.request, {++sequence}));
    outcome.cause == Cause::kNoAnswer && !outcome.done
        ? row.pass()
        : row.fail(fmt::format("{}: {}", example.name, outcome.text()), frames(outcome.sent));
  }
  rows.push_back(std::move(row));
}

// Responses of a neighbour; with sequence numbers also of the previous request.
void strangers(const Subject& subject, const Requests& requests, CheckRows& rows) {
  CheckRow row{.check = "wrong station", .where = "responses"};
  CheckRow old{.check = "late response", .where = "of the request before"};
  const ResponseIdentity identity = requests.protocol().traits().identity;
  if (identity == ResponseIdentity::kNone)
    row.note =
        "responses carry no address: the engine lets the line fall silent (see late response)";
  if (identity != ResponseIdentity::kSequence)
    old.note = "responses carry no sequence: the engine keeps requests apart";
  const std::optional<Subject> neighbour = subject.neighbour();
  if (!neighbour) row.note = "one address: there is no other station";
  const Subject& other_one = neighbour ? *neighbour : subject;
  const auto other = other_one.protocol();
  LiveDevice there(other_one), here(subject);
  std::uint16_t sequence = 0;
  for (const NamedRequest& example : requests.examples()) {
    ++sequence;
    const auto tell = [&](CheckRow& into, const RunOutcome& answered) {
      const RunOutcome outcome = replay(requests.protocol().begin(example.request, {sequence}),
                                        subject.line(), answered.answers);
      outcome.says_something()
          ? into.fail(fmt::format("{}: {}", example.name, outcome.text()), frames(answered.answers))
          : into.pass();
    };
    if (identity != ResponseIdentity::kNone && neighbour)
      tell(row, there.run(other->begin(example.request, {sequence})));
    if (identity == ResponseIdentity::kSequence) {
      tell(old, here.run(requests.protocol().begin(example.request,
                                                   {static_cast<std::uint16_t>(sequence + 1)})));
    }
  }
  rows.push_back(std::move(row));
  rows.push_back(std::move(old));
}

}  // namespace

void check_troubles(const Subject& subject, CheckRows& rows) {
  const Requests requests(subject);
  refusals(subject, requests, rows);
  silence(subject, requests, rows);
  strangers(subject, requests, rows);
}

}  // namespace fieldcast::sim
