// An Engineer in virtual time: feeds events and stores the actions.
//
// Owns the Engineer and the clock. Runs on the thread of the test. pair() fails the test if the
// Engineer does not pair.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "core/program/engineer.hpp"

namespace fieldcast::program {

struct EngineerBench {
  explicit EngineerBench(EngineerRules rules = {}) : engineer(rules, now) { tell(TimerFired{}); }

  void tell(const EngineerEvent& event) {
    EngineerActions actions;
    engineer.on_event(event, now, actions);
    for (EngineerAction& action : actions) {
      if (auto* to = std::get_if<ToClient>(&action)) append(client, to->bytes);
      if (auto* to = std::get_if<ToDevice>(&action)) append(device, to->bytes);
      if (auto* login = std::get_if<CheckLogin>(&action))
        logins.push_back(login->user + '/' + login->password);
      if (auto* take = std::get_if<TakeDevice>(&action)) taken.push_back(take->number);
      if (auto* line = std::get_if<SetLine>(&action)) lines.push_back(line->settings);
      if (std::holds_alternative<ListDevices>(action)) ++lists;
      if (std::holds_alternative<FreeDevice>(action)) ++freed;
      if (std::holds_alternative<HangUp>(action)) ++hung_up;
      if (auto* timer = std::get_if<SetTimer>(&action)) wake = timer->at;
      if (auto* remark = std::get_if<Remark>(&action)) remarks.push_back(*remark);
    }
  }
  void sends(std::string_view text) { tell(FromClient{as_bytes(text)}); }
  void answers(std::string_view text) { tell(FromDevice{as_bytes(text)}); }
  void pass(Duration time) {
    const Instant until = now + time;
    while (wake <= until) {
      now = std::max(now, wake);
      wake = kNever;
      tell(TimerFired{});
    }
    now = until;
  }
  void pair(std::string_view request = "@@17FEFF") {
    sends(request);
    tell(DeviceGiven{});
    ASSERT_TRUE(engineer.paired());
    client.clear();
  }
  std::string received() { return std::string(as_text(std::exchange(client, {}))); }
  std::string reached() { return std::string(as_text(std::exchange(device, {}))); }
  [[nodiscard]] std::string last_remark() const {
    return remarks.empty() ? "" : remarks.back().text;
  }

  Instant now{std::chrono::seconds{1000}};
  Instant wake = kNever;
  Engineer engineer;
  Bytes client, device;
  std::vector<std::string> logins, taken;
  std::vector<LineSettings> lines;
  std::vector<Remark> remarks;
  int lists = 0, freed = 0, hung_up = 0;
};

}  // namespace fieldcast::program
