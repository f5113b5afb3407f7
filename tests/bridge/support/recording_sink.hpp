#pragma once

#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "bridge/bus/bus_runner.hpp"

namespace fieldcast::test {

class RecordingSink final : public BusSink {
 public:
  struct Record {
    std::vector<Sample> samples;
    std::vector<UtcTime> acquired;
    std::vector<CommandResult> results;
    std::vector<BusReport> reports;
    std::map<std::string, DeviceReport, std::less<>> devices;
    std::vector<PlanReport> plans;
  };

  void publish(std::vector<Sample> samples, const UtcMapping& mapping) override {
    note([&](Record& r) {
      for (const Sample& sample : samples) {
        r.samples.push_back(sample);
        r.acquired.push_back(mapping.to_utc(sample.acquired));
      }
    });
  }
  void promise(ChannelIndex, std::optional<Duration>) override {}
  void complete(const CommandResult& result, const UtcMapping&) override {
    note([&](Record& r) { r.results.push_back(result); });
  }
  void report(const BusReport& report, UtcTime) override {
    note([&](Record& r) { r.reports.push_back(report); });
  }
  void report(std::string_view device, const DeviceReport& report, UtcTime) override {
    note([&](Record& r) { r.devices.insert_or_assign(std::string(device), report); });
  }
  void report(PlanReport plan, UtcTime) override {
    note([&](Record& r) { r.plans.push_back(std::move(plan)); });
  }

  [[nodiscard]] bool wait_for(const std::function<bool(const Record&)>& done,
                              std::chrono::milliseconds limit = std::chrono::seconds{10}) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, limit, [&] { return done(record_); });
  }
  [[nodiscard]] Record record() {
    const std::lock_guard lock(mutex_);
    return record_;
  }

 private:
  void note(const std::function<void(Record&)>& change) {
    {
      const std::lock_guard lock(mutex_);
      change(record_);
    }
    changed_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  Record record_;
};

}  // namespace fieldcast::test
