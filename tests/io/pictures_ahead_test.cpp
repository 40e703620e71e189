// Pictures that are decoded before they are asked for.
#include "runtime/error.h"
#include "runtime/io/pictures_ahead.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

namespace gradus {
namespace {

constexpr std::uint64_t no_limit = ~std::uint64_t(0);

std::vector<Picture> numbered(int count) {
    std::vector<Picture> pictures;
    for (int i = 0; i < count; ++i)
        pictures.push_back({.path = std::to_string(i)});
    return pictures;
}

/// As many words as the name says. Those of three and its multiples fail.
ReadBitmap decoded(const Picture &picture) {
    const int number = std::stoi(picture.path.string());
    if (number % 3 == 0)
        throw Error(ExitCode::image, "no " + picture.path.string());
    ReadBitmap read;
    read.bitmap.words.resize(std::size_t(number));
    return read;
}

void expect_taken(PicturesAhead &ahead, int number) {
    const Picture picture{.path = std::to_string(number)};
    if (number % 3 != 0) {
        EXPECT_EQ(ahead.take(picture).bitmap.words.size(), std::size_t(number));
        return;
    }
    try {
        ahead.take(picture);
        ADD_FAILURE() << number;
    } catch (const Error &error) {
        EXPECT_EQ(error.what(), "no " + picture.path.string());
    }
}

TEST(PicturesAhead, AreGivenInAnyOrder) {
    for (const unsigned threads : {0u, 1u, 7u}) {
        PicturesAhead ahead(numbered(100), threads, no_limit, decoded);
        for (int i = 0; i < 100; ++i)
            expect_taken(ahead, i * 37 % 100);
        expect_taken(ahead, 4);   // again
        expect_taken(ahead, 500); // which nobody announced
    }
}

TEST(PicturesAhead, AreDecodedOnce) {
    std::atomic<int> count = 0;
    {
        std::vector<Picture> twice = numbered(50);
        const std::vector<Picture> same = twice;
        twice.insert(twice.end(), same.begin(), same.end());
        PicturesAhead ahead(twice, 3, no_limit, [&](const Picture &picture) {
            ++count;
            return decoded(picture);
        });
        for (int i = 49; i >= 0; --i)
            expect_taken(ahead, i);
    }
    EXPECT_EQ(count, 50);
}

TEST(PicturesAhead, WaitWhileMuchIsNotTaken) {
    std::atomic<int> count = 0;
    // Of 1000 bytes or more each, which nobody takes: a thread begins with one more.
    PicturesAhead ahead({{.path = "250"}, {.path = "251"}, {.path = "253"}, {.path = "254"}}, 1, 1500,
                        [&](const Picture &picture) {
                            ++count;
                            return decoded(picture);
                        });
    for (int wait = 0; wait < 200 && count < 2; ++wait)
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    EXPECT_EQ(count, 2);
    expect_taken(ahead, 250);
    expect_taken(ahead, 254);
    expect_taken(ahead, 253);
}

TEST(PicturesAhead, AreDecodedByWhoWaitsForOne) {
    std::atomic<int> begun = 0;
    std::atomic<bool> is_alone = false;
    // Each of the first two waits for the other to begin: one thread would not do it.
    PicturesAhead ahead({{.path = "1"}, {.path = "2"}}, 1, no_limit, [&](const Picture &picture) {
        ++begun;
        for (int wait = 0; wait < 500 && begun < 2; ++wait)
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        is_alone = is_alone || begun < 2;
        return decoded(picture);
    });
    while (begun == 0)
        std::this_thread::yield();
    expect_taken(ahead, 1);
    expect_taken(ahead, 2);
    EXPECT_FALSE(is_alone);
}

TEST(PicturesAhead, MayBeLeft) {
    for (int i = 0; i < 20; ++i)
        PicturesAhead(numbered(20), 2, no_limit, decoded);
}

} // namespace
} // namespace gradus
