// Regular expressions for tests: those of POSIX, for <regex> takes seconds to compile and as long to run.
#pragma once

#include <regex.h>

#include <array>
#include <stdexcept>
#include <string>
#include <vector>

namespace gradus::testing {

/// An extended regular expression.
class Pattern {
  public:
    using Match = std::array<std::string, 3>; ///< the whole, and the first groups

    explicit Pattern(const char *text) {
        if (regcomp(&compiled_, text, REG_EXTENDED) != 0)
            throw std::invalid_argument(text);
    }
    ~Pattern() { regfree(&compiled_); }
    Pattern(const Pattern &) = delete;
    Pattern &operator=(const Pattern &) = delete;

    std::vector<Match> all_in(const std::string &text) const {
        std::vector<Match> found;
        for_each_in(text, [&](const Places &places) {
            Match match;
            for (std::size_t i = 0; i < match.size(); ++i)
                if (places[i].rm_so >= 0)
                    match[i] = text.substr(std::size_t(places[i].rm_so), length(places[i]));
            found.push_back(match);
        });
        return found;
    }
    bool is_in(const std::string &text) const { return regexec(&compiled_, text.c_str(), 0, nullptr, 0) == 0; }
    std::string replaced_in(const std::string &text, const std::string &with) const {
        std::string result;
        std::size_t copied = 0;
        for_each_in(text, [&](const Places &places) {
            const auto begin = std::size_t(places[0].rm_so);
            result.append(text, copied, begin - copied).append(with);
            copied = begin + length(places[0]);
        });
        return result.append(text, copied);
    }

  private:
    using Places = std::array<regmatch_t, 3>;

    static std::size_t length(const regmatch_t &place) { return std::size_t(place.rm_eo - place.rm_so); }

    /// Matches of some length, from left to right.
    template <class Visit>
    void for_each_in(const std::string &text, Visit visit) const {
        Places places;
        places[0] = {0, regoff_t(text.size())};
        while (regexec(&compiled_, text.c_str(), places.size(), places.data(), REG_STARTEND) == 0 &&
               length(places[0]) > 0) {
            visit(places);
            places[0] = {places[0].rm_eo, regoff_t(text.size())};
        }
    }

    regex_t compiled_;
};

} // namespace gradus::testing
