// Connects a member of a standby group with the others: publishes its state, and receives theirs.
// Handlers are called on DDS threads and only post. Owns its endpoints; created and closed like
// those of the link. tell() has one caller at a time for each kind of message.
#pragma once

#include <functional>
#include <map>
#include <mutex>
#include <string>

#include "bridge/dds/receivers/taker.hpp"
#include "bridge/dds/transport/domain.hpp"
#include "bridge/standby/standby_values.hpp"
#include "core/base/time.hpp"
#include "idl/topics.h"

namespace fieldcast {

struct StandbyChannelHandlers {
  std::function<void(const StandbyMessage&)> member;    // a message of a member of the group
  std::function<void(const std::string& bridge)> lost;  // it has left the domain
  std::function<void(const StandbyNote&)> note;
  std::function<void(const StandbyRequest&)> request;
};

class StandbyChannel {
 public:
  // `since`: start time of the member. Of two writers of one name, the reader accepts the later
  // one: DDS removes a killed member only after its lease, and never if a discovery server has
  // restarted meanwhile. Throws DdsError.
  StandbyChannel(Domain& domain, const std::string& label, std::string group, UtcTime since,
                 StandbyChannelHandlers handlers);
  ~StandbyChannel();
  StandbyChannel(const StandbyChannel&) = delete;
  StandbyChannel& operator=(const StandbyChannel&) = delete;

  void tell(const StandbyMessage& message);
  void tell(const StandbyNote& note);
  void close();  // no handler is called after it returns; a second call has no effect

 private:
  class MemberTaker : public Taker<idl::Standby> {
   public:
    MemberTaker(StandbyChannel& channel, Take take) : Taker(std::move(take)), channel_(channel) {}

   private:
    void on_subscription_matched(dds::DataReader*,
                                 const dds::SubscriptionMatchedStatus& status) override {
      if (status.current_count_change < 0) channel_.on_gone(status.last_publication_handle);
    }
    StandbyChannel& channel_;
  };
  void on_member(const idl::Standby& message, const dds::SampleInfo& info);
  void on_gone(const dds::InstanceHandle_t& writer);

  Domain& domain_;
  const std::string group_;
  const StandbyChannelHandlers handlers_;
  std::mutex mutex_;
  std::map<dds::InstanceHandle_t, std::string> bridges_;  // by writer
  MemberTaker members_;
  Taker<idl::StandbyNote> notes_;
  Taker<idl::StandbyRequest> requests_;
  dds::DataReader* member_reader_ = nullptr;
  dds::DataReader* note_reader_ = nullptr;
  dds::DataReader* request_reader_ = nullptr;
  dds::DataWriter* member_writer_ = nullptr;
  dds::DataWriter* note_writer_ = nullptr;
};

}  // namespace fieldcast
