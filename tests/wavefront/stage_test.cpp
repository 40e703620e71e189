// What a stage is built from and what a launch passes to it.
#include "runtime/wavefront/stage.h"

#include "methods/method.h"
#include "planning/make_method.h"
#include "runtime/device/launch_observer.h"
#include "runtime/wavefront/table_layout.h"
#include "tests/support/render.h"
#include "tests/support/small_scenes.h"

#include <gmock/gmock.h>

#include <set>
#include <stdexcept>

namespace gradus {
namespace {

using ::testing::HasSubstr;
using ::testing::IsSupersetOf;
using ::testing::Not;

Scene room(const std::vector<Bsdf> &bsdfs) {
    testing::SceneMaker maker(6, 2);
    maker.look({0, 1, 4}, {0, 1, 0}, 50);
    for (std::size_t i = 0; i < bsdfs.size(); ++i)
        maker.sphere({float(i) - 1, 0.5f, 0}, 0.5f, maker.material(bsdfs[i]));
    maker.floor(-3, 3, 3, maker.material(testing::diffuse(0.5)));
    maker.lamp({0, 3, 0}, 1, 1, 5, maker.material(testing::diffuse(0.5)));
    maker.scene.settings.max_depth = 5;
    return maker.scene;
}

/// The stage `connect` on two rows, with what the caller declares.
struct ConnectStage {
    explicit ConnectStage(Device &device, StageDeclaration declaration, const TableList &list)
        : session(device, room({}), {}, {}), stage(stages.add(std::move(declaration))),
          tables(device, list, {64, 64, 36, 6, 1}, Precision::single) {
        session.numbers["capacity"] = session.numbers["slots"] = 64;
    }
    void build() { stages.build(session, tables); }
    static TableList all_tables() {
        return {{.name = "path", .columns = 9, .alternates = true},
                {.name = "shadow", .columns = 10},
                {.name = "radiance", .rows = RowsOf::slot, .columns = 3}};
    }
    Session session;
    Stages stages;
    Stage &stage;
    Tables tables;
};

TEST(StageOf, IsBuiltWithAllItsArguments) {
    Device device;
    ConnectStage test(device, {.name = "connect", .numbers = {"first"}}, ConnectStage::all_tables());
    EXPECT_NO_THROW(test.build());
    EXPECT_TRUE(test.stage.is_wanted());
}

TEST(StageOf, NamesTheArgumentThatNobodyProvides) {
    Device device;
    const auto message = [](ConnectStage &test) -> std::string {
        try {
            test.build();
        } catch (const std::logic_error &error) {
            return error.what();
        }
        return "";
    };
    ConnectStage without_number(device, {.name = "connect"}, ConnectStage::all_tables());
    EXPECT_THAT(message(without_number), HasSubstr("first"));
    TableList list = ConnectStage::all_tables();
    list.pop_back();
    ConnectStage without_table(device, {.name = "connect", .numbers = {"first"}}, list);
    EXPECT_THAT(message(without_table), HasSubstr("radiance"));
    ConnectStage without_capacity(device, {.name = "connect", .numbers = {"first"}}, ConnectStage::all_tables());
    without_capacity.session.numbers.erase("capacity");
    EXPECT_THAT(message(without_capacity), HasSubstr("capacity"));
}

TEST(StageOf, TakesATableOfAnotherName) {
    Device device;
    TableList list = ConnectStage::all_tables();
    list.back().name = "direct";
    ConnectStage test(device, {.name = "connect", .numbers = {"first"}, .tables = {{"radiance", "direct"}}}, list);
    EXPECT_NO_THROW(test.build());
}

TEST(StageOf, ThatIsNotWantedIsNotBuilt) {
    Device device;
    ConnectStage test(device, {.name = "no such file", .is_wanted = false}, {});
    EXPECT_NO_THROW(test.build());
    EXPECT_FALSE(test.stage.is_wanted());
    EXPECT_NO_THROW(test.stage.run(64, {{"first", 0}}));
}

TEST(StageOf, WorksOnTheTablesAsTheyAlternate) {
    Device device;
    std::vector<const void *> paths;
    std::vector<std::uint32_t> firsts;
    observe_launches(device, [&](const Launch &launch) {
        if (std::get<std::uint32_t>(launch.arguments.at("count").value) == 0)
            return;
        const Buffer &buffer = std::get<Buffer>(launch.arguments.at("path").value);
        paths.push_back(*static_cast<void *const *>(buffer.argument()));
        firsts.push_back(std::get<std::uint32_t>(launch.arguments.at("first").value));
    });
    ConnectStage test(device, {.name = "connect", .numbers = {"first"}}, ConnectStage::all_tables());
    test.build();
    for (const char *name : {"path", "shadow"})
        test.tables[name].clear();
    std::vector<const void *> expected;
    for (std::uint32_t first = 0; first < 3; ++first) {
        expected.push_back(*static_cast<void *const *>(test.tables["path"].argument()));
        test.tables["path"].clear();
        test.stage.run(2, {{"first", first}});
        finish(device);
        test.tables.exchange();
    }
    test.stage.run(0, {{"first", 7}});
    observe_launches(device, {});
    EXPECT_EQ(paths, expected);
    EXPECT_NE(paths[0], paths[1]);
    EXPECT_THAT(firsts, ::testing::ElementsAre(0, 1, 2));
}

/// What a render gives its kernels.
struct Seen {
    std::set<std::string> stages, tables;
};

Seen watch(const char *method, const Scene &scene, const RenderOptions &options) {
    Device device;
    Seen seen;
    observe_launches(device, [&](const Launch &launch) {
        if (!launch.request.file.starts_with("kernels/stages/"))
            return;
        seen.stages.insert(launch.request.name);
        const auto number = [&](const char *name) -> std::size_t {
            const auto found = launch.arguments.find(name);
            return found == launch.arguments.end() ? 0 : std::get<std::uint32_t>(found->second.value);
        };
        const TableSizes sizes = {number("capacity"),   number("slots"),      number("pixels"),
                                  number("crop_width"), number("own_rows"),   number("photon_rows"),
                                  number("pair_rows"),  number("chain_rows"), number("chain_vertices")};
        for (const auto &[name, argument] : launch.arguments) {
            const auto *buffer = std::get_if<Buffer>(&argument.value);
            const TableLayout *layout = table_layout(name);
            if (!buffer || !layout || argument.type.starts_with("uint"))
                continue;
            if (name != "camera" && name != "own_vertex")
                seen.tables.insert(name);
            const std::size_t column = layout->rows(sizes) * sizeof(float);
            if (std::get<std::uint32_t>(launch.arguments.at("count").value) == 0 || buffer->bytes() == 0)
                continue;
            // A scene may do without the last columns.
            ASSERT_GT(column, 0u) << name << " of " << launch.request.name;
            EXPECT_EQ(buffer->bytes() % column, 0u) << name << " of " << launch.request.name;
            EXPECT_LE(buffer->bytes() / column, layout->columns.size()) << name << " of " << launch.request.name;
        }
    });
    const std::unique_ptr<Method> render = make_method(method, device, scene, options);
    while (render->render_batch()) {
    }
    observe_launches(device, {});
    return seen;
}

// By the launches of a render: tables have the rows that kernels are told, and what no trait asks for is not there.
TEST(TablesOfARender, AreThoseThatTheSceneAsksFor) {
    RenderOptions options;
    const Seen path = watch("pt", room({}), options);
    EXPECT_THAT(path.tables, Not(::testing::Contains("feature")));
    EXPECT_THAT(path.stages, Not(::testing::Contains("escape")));
    const Seen rough = watch("gpt", room({}), options);
    for (const char *table : {"offset_vertex", "offset_ray", "feature", "feature_film"})
        EXPECT_THAT(rough.tables, Not(::testing::Contains(table)));
    EXPECT_THAT(rough.stages, Not(::testing::Contains("advance apart")));
    EXPECT_THAT(rough.stages, Not(::testing::Contains("evaluate diffuse"))) << "shift evaluates the only kind itself";
    options.aov = true;
    const Seen smooth = watch("gpt", room({testing::mirror(), testing::rough_glass(0.2, 1.5)}), options);
    EXPECT_THAT(smooth.tables, IsSupersetOf({"offset_vertex", "offset_ray", "feature", "feature_film"}));
    EXPECT_THAT(smooth.stages, IsSupersetOf({"advance apart", "weigh apart", "shift diffuse", "shift conductor",
                                             "evaluate diffuse", "evaluate conductor"}));
}

TEST(TablesOfARender, TakeNoMemoryThatTheSceneDoesNotAskFor) {
    const auto bytes = [](const Scene &scene, bool aov) {
        Device device;
        RenderOptions options;
        options.aov = aov;
        options.batch_size = 64;
        make_method("gpt", device, scene, options);
        return peak_device_bytes(device);
    };
    const Scene rough = room({});
    Scene smooth = rough;
    smooth.materials[0].front.kind = BsdfKind::conductor; // as many records
    EXPECT_LT(bytes(rough, false), bytes(rough, true));
    EXPECT_LT(bytes(rough, false), bytes(smooth, false));
}

} // namespace
} // namespace gradus
