// Watches the folder of a member while its participant is in the domain. A new list of revoked
// certificates takes effect immediately, without a restart. A renewed certificate is only reported,
// because Fast DDS 2.9.1 reads it when a participant is created.
//
// Owns a thread, "members", that checks the files every kPeriod. A refused participant stays
// refused until the process ends, even if the list changes. A list that the authority has not
// signed is ignored and reported.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>

#include "bridge/dds/filter/incoming_filter.hpp"

namespace fieldcast {

class MemberWatch {
 public:
  static constexpr auto kPeriod = std::chrono::milliseconds{500};

  MemberWatch(std::string folder, std::shared_ptr<IncomingFilter> filter);
  ~MemberWatch();
  MemberWatch(const MemberWatch&) = delete;
  MemberWatch& operator=(const MemberWatch&) = delete;

  // Returns true if the folder has a valid certificate other than the one at construction. Any
  // thread.
  [[nodiscard]] bool has_new_identity() const;

 private:
  void run();
  void read_list();
  void look_at_identity();
  void look_at_refused();

  const std::string folder_;
  const std::shared_ptr<IncomingFilter> filter_;
  const std::string identity_;
  std::uint64_t say_refused_ = 1;  // next count of messages in clear to report
  std::uint32_t renewed_ = 0;      // successive checks that saw another certificate
  std::string list_;               // the last valid one
  std::uint32_t wrong_ = 0;        // successive checks that saw an invalid file
  std::set<std::string> refused_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool ends_ = false;
  std::thread thread_;  // last member: it uses the members above
};

}  // namespace fieldcast
