#include "bridge/station/standby_monitor.hpp"

#include <condition_variable>
#include <mutex>

#include "bridge/dds/topics/conversion.hpp"
#include "bridge/dds/transport/domain.hpp"
#include "bridge/station/subscription.hpp"

namespace fieldcast {

struct StandbyMonitor::State : dds::DataWriterListener {
  State(const DdsSpec& spec, std::string given, StandbyMonitor::Handlers handlers)
      : name(std::move(given)), domain(spec, name, nullptr) {
    Subscription<idl::StandbyPubSubType>::Handlers heard;
    heard.sample = [member = std::move(handlers.member)](const idl::Standby& message) {
      if (const auto told = from_idl(message)) member(*told);
    };
    if (handlers.gone) {
      heard.gone = [gone = std::move(handlers.gone)](const idl::Standby& last) {
        gone(last.group().c_str(), last.bridge().c_str());
      };
    }
    members = std::make_unique<Subscription<idl::StandbyPubSubType>>(domain, kStandbyTopic,
                                                                     std::move(heard));
  }
  ~State() override {
    if (writer != nullptr) domain.remove(writer);
  }
  void on_publication_matched(dds::DataWriter*,
                              const dds::PublicationMatchedStatus& status) override {
    const std::lock_guard lock(mutex);
    bridges = status.current_count;
    changed.notify_all();
  }

  const std::string name;
  Domain domain;
  std::unique_ptr<Subscription<idl::StandbyPubSubType>> members;
  std::mutex mutex;
  std::condition_variable changed;
  int bridges = 0;
  dds::DataWriter* writer = nullptr;
};

StandbyMonitor::StandbyMonitor(const DdsSpec& spec, const std::string& name, Handlers handlers)
    : state_(std::make_unique<State>(spec, name, std::move(handlers))) {}

StandbyMonitor::~StandbyMonitor() = default;

bool StandbyMonitor::request(const StandbyRequest& wanted, Duration limit) {
  if (state_->writer == nullptr) {
    state_->writer = state_->domain.writer(kStandbyRequestTopic, state_->name, state_.get(),
                                           dds::StatusMask::publication_matched());
  }
  {
    std::unique_lock lock(state_->mutex);
    if (!state_->changed.wait_for(lock, limit, [this] { return state_->bridges > 0; }))
      return false;
  }
  // All bridges found so far receive it; one that is found later may be the master.
  const auto end = std::chrono::steady_clock::now() + limit;
  idl::StandbyRequest out;
  to_idl(wanted, out);
  state_->writer->write(&out);
  const auto left = std::max(end - std::chrono::steady_clock::now(), Duration::zero());
  return state_->writer->wait_for_acknowledgments(to_dds(left)) == ReturnCode_t::RETCODE_OK;
}

}  // namespace fieldcast
