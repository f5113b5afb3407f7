// Looks every few seconds who the users of the store are: logins of users who are gone, have
// another role or a new password end, and the role of everybody without a login follows. Lives on
// the io thread.
#pragma once

#include <boost/asio/steady_timer.hpp>
#include <functional>
#include <optional>
#include <vector>

#include "bridge/store/user_table.hpp"
#include "tools/station/configuration.hpp"
#include "tools/station/web/site.hpp"

namespace fieldcast::web {

// What those may do who are not logged in. `users`: how many there are; nothing: not known, or
// unknown whether there are any. Nothing comes back: they have to log in.
[[nodiscard]] std::optional<Role> local_role_of(const StationSpec& spec,
                                                std::optional<std::size_t> users);

class UserWatch {
 public:
  static constexpr Duration kPeriod = std::chrono::seconds{5};
  using Users = std::optional<std::vector<User>>;  // nothing: the store cannot be asked now
  // Asks the store without blocking; `done` is called on the io thread.
  using Ask = std::function<void(std::function<void(Users)> done)>;

  // The site must outlive it.
  UserWatch(boost::asio::io_context& io, const StationSpec& spec, Site& site, Ask ask);
  ~UserWatch();
  UserWatch(const UserWatch&) = delete;
  UserWatch& operator=(const UserWatch&) = delete;

  void look();

 private:
  void on_users(const Users& users);

  const StationSpec spec_;
  Site& site_;
  const Ask ask_;
  boost::asio::steady_timer timer_;
  std::optional<std::size_t> users_;  // how many there were when the store was asked last
  std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);
};

}  // namespace fieldcast::web
