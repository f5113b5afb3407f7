// Requests to stop that other parts of the program make.
#pragma once

namespace fieldcast::port {

// The session ends as by Ctrl-C; a request before the session begins ends it at its start. Any
// thread.
void request_stop();

// From now on only request_stop() ends the session. For a service: Windows reports to it that a
// user has logged off, which any user may do. Call it before the session.
void ignore_console();

}  // namespace fieldcast::port
