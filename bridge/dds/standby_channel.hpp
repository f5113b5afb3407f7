// A member of a standby group among the others: tells them what it is, and receives what they tell.
// Handlers are called on DDS threads, must not block, and only post.
//
// Owns its endpoints. Made and closed like those of the link (dds_link.hpp); tell() comes from one
// thread at a time for each kind of message.
#pragma once

#include <functional>
#include <map>
#include <mutex>
#include <string>

#include "bridge/dds/domain.hpp"
#include "bridge/dds/taker.hpp"
#include "bridge/dds/topics/utc_mapping.hpp"
#include "bridge/standby/standby_values.hpp"
#include "idl/topics.h"

namespace fieldcast {

struct StandbyChannelHandlers {
  std::function<void(const StandbyMessage&)> member;    // of the group
  std::function<void(const std::string& bridge)> lost;  // it has left the domain
  std::function<void(const StandbyNote&)> note;
  std::function<void(const StandbyRequest&)> request;
};

class StandbyChannel {
 public:
  // `since`: when the member begins. Of two writers of one name the one that began later is heard:
  // DDS gives up a member that was killed only after its lease, and never where a discovery server
  // has begun anew meanwhile. Throws DdsError.
  StandbyChannel(Domain& domain, const std::string& label, std::string group, UtcTime since,
                 StandbyChannelHandlers handlers);
  ~StandbyChannel();  // close()
  StandbyChannel(const StandbyChannel&) = delete;
  StandbyChannel& operator=(const StandbyChannel&) = delete;

  void tell(const StandbyMessage& message);
  void tell(const StandbyNote& note);
  void close();  // nothing is handed on after it returns; a second call has no effect

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
