-- load.lua: script of wrk for scripts/load: mated verifications of all subjects in turn.
-- Arguments: the folder with the scans; their file extension; a token; the number of subjects;
-- and the time in ms that a connection waits before each request.
-- One thread only.  Prints one line at the end:
--   requests seconds p50 p95 p99 matches busy lost
-- Times in ms; busy: responses with 503; lost: all other requests.
local type_of = {ply = "model/x-ply", json = "application/json"}
local requests, turn, pause = {}, 0, 0
local worker

matches, busy, other = 0, 0, 0 -- global, because done() cannot reach them otherwise

function setup(thread)
    worker = thread
end

function init(args)
    local folder, ending, token = args[1], args[2], args[3]

    for s = 1, tonumber(args[4]) do
        local file = assert(io.open(folder .. "/" .. s .. "-probe." .. ending, "rb"))

        requests[s] = wrk.format("POST", "/v1/subjects/s" .. s .. "/verify", {
            ["Authorization"] = "Bearer " .. token,
            ["Content-Type"] = type_of[ending],
        }, file:read("*a"))
        file:close()
    end
    pause = tonumber(args[5])
    if pause > 0 then
        math.randomseed(1)
        delay = function() -- random, or all connections would send at the same time
            return math.floor(pause * (0.5 + math.random()) + 0.5)
        end
    end
end

function request()
    turn = turn % #requests + 1
    return requests[turn]
end

function response(status, _, body)
    if status == 200 and body:find('"decision":%s*"match"') then
        matches = matches + 1
    elseif status == 503 then
        busy = busy + 1
    else
        other = other + 1
    end
end

function done(summary, latency)
    local e = summary.errors

    io.write(string.format("result %d %.3f %.2f %.2f %.2f %d %d %d\n", summary.requests,
        summary.duration / 1e6, latency:percentile(50) / 1e3, latency:percentile(95) / 1e3,
        latency:percentile(99) / 1e3, worker:get("matches"), worker:get("busy"),
        worker:get("other") + e.connect + e.read + e.write + e.timeout))
end
