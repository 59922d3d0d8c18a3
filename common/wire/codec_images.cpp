// SPDX-FileCopyrightText: 2026 The CoSLAM authors
// SPDX-License-Identifier: Apache-2.0
//
// What became of an agent's images.
#include <algorithm>
#include <limits>
#include <tuple>

#include "common/wire/checks.h"

namespace coslam {
namespace {

constexpr std::size_t kMostProblem = 512;
static_assert(std::tuple_size_v<std::decay_t<decltype(idl::AgentImages().images())>> == kImageFates);

}  // namespace

idl::AgentImages encode(const AgentImages& a) {
  constexpr std::uint64_t kMost = std::numeric_limits<std::uint32_t>::max();
  idl::AgentImages m;
  m.agent_run(a.agent_run.value);
  m.server_run(a.server_run.value);
  for (std::size_t i = 0; i < kImageFates; ++i) {
    m.images()[i] = static_cast<std::uint32_t>(std::min(a.images.images[i], kMost));
  }
  m.complete(a.complete);
  m.agent(a.agent);
  m.problem(a.problem.substr(0, kMostProblem));
  return m;
}

Decoded<AgentImages> decode(const idl::AgentImages& m) {
  AgentImages a{m.agent().to_string(), RunId(m.agent_run()),   RunId(m.server_run()), {},
                m.complete(),          m.problem().to_string()};
  const Problem problem = first_of({check_sender(a.agent, a.agent_run), check_id(a.server_run),
                                    a.problem.empty() ? std::nullopt : check_sentence(a.problem, kMostProblem)});
  if (problem) return *problem;
  std::ranges::copy(m.images(), a.images.images.begin());
  return a;
}

}  // namespace coslam
