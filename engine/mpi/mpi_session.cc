// SPDX-License-Identifier: GPL-3.0-or-later
#include "engine/mpi/mpi_session.h"

#include <limits>

#include <mpi.h>

#include "engine/error.h"

namespace ptin {

namespace {

constexpr int kTag = 1;

void check(int status, const char* what) {
  if (status != MPI_SUCCESS) {
    throw Error(ErrorCode::io_error, std::string("MPI cannot ") + what);
  }
}

}  // namespace

MpiSession::MpiSession() {
  int given = 0;
  if (MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &given) != MPI_SUCCESS) {
    throw Error(ErrorCode::internal, "MPI does not begin");
  }
  MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  MPI_Comm_size(MPI_COMM_WORLD, &ranks_);
}

MpiSession::~MpiSession() { MPI_Finalize(); }

void MpiSession::send(int rank, const std::string& text) const {
  if (text.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
    throw Error(ErrorCode::internal, "a message of more than 2 GiB");
  }
  check(MPI_Send(text.data(), static_cast<int>(text.size()), MPI_CHAR, rank, kTag, MPI_COMM_WORLD),
        "send a message");
}

std::optional<MpiSession::Received> MpiSession::receive() const {
  int is_there = 0;
  MPI_Status status;
  check(MPI_Iprobe(MPI_ANY_SOURCE, kTag, MPI_COMM_WORLD, &is_there, &status), "look for messages");
  if (is_there == 0) {
    return std::nullopt;
  }
  int bytes = 0;
  check(MPI_Get_count(&status, MPI_CHAR, &bytes), "tell the size of a message");
  Received received{status.MPI_SOURCE, std::string(static_cast<std::size_t>(bytes), '\0')};
  check(MPI_Recv(received.text.data(), bytes, MPI_CHAR, status.MPI_SOURCE, kTag, MPI_COMM_WORLD,
                 MPI_STATUS_IGNORE),
        "receive a message");
  return received;
}

}  // namespace ptin
